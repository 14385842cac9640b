import type { Preview } from '../../preview/preview'
import type { PreviewStatus } from '../../preview/status'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { readable } from './settingGroups'

const { motion: words } = text
const STILL = 'still'

interface Props {
  readonly status: PreviewStatus
  preview(): Pick<Preview, 'setAnimation'>
  toSettings(): void
}

/** The choice between no motion and the animations of the file; where it has none, a button that leads to the wind's settings. */
export function AnimationSwitch({ status, preview, toSettings }: Props) {
  const isTree = status.shows === 'model' && status.webgl !== 'absent'
  const hasAny = isTree && status.animations.length > 0
  const names = [STILL, ...status.animations]
  const chosen = status.animation ?? STILL
  const choose = (name: string) => preview().setAnimation(name === STILL ? null : name)
  return (
    <div class="animations">
      <div class="overlay animation-buttons" role="group" aria-label={words.group} hidden={!hasAny}>
        <Icon path={ICONS.wind} />
        {names.map(name => (
          <button type="button" class="button" key={name} aria-pressed={name === chosen} onClick={() => choose(name)}>
            {nameOf(name)}
          </button>
        ))}
      </div>
      <select
        class="overlay animation-list"
        aria-label={words.group}
        hidden={!hasAny}
        value={chosen}
        onChange={event => choose(event.currentTarget.value)}
      >
        {names.map(name => (
          <option value={name} key={name}>
            {nameOf(name)}
          </option>
        ))}
      </select>
      <div class="overlay no-wind" hidden={!isTree || hasAny}>
        <button type="button" class="button" title={words.addHow} aria-label={words.add} onClick={toSettings}>
          <Icon path={ICONS.wind} />
          <span class="roomy">{words.add}</span>
        </button>
      </div>
    </div>
  )
}

function nameOf(animation: string): string {
  return words.names[animation] ?? readable(animation)
}
