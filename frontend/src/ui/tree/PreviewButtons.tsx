import { PARTS, type Part } from '../../preview/capture/measured'
import type { Preview } from '../../preview/preview'
import type { PreviewStatus, View } from '../../preview/status'
import type { State } from '../../state'
import { variantsOf } from '../../studio/variants'
import { text } from '../../text'
import { canEdit } from '../capture/EditTools'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { useStore, useStudio } from '../parts/useStore'
import { isBareDrawing } from './previewContent'

const VIEWS: readonly View[] = ['photo', 'front', 'side', 'back', 'top']
const STEP = 1.25
/** More trees than these are chosen from a list. */
const MOST_BUTTONS = 6

interface Props {
  readonly status: PreviewStatus
  preview(): Pick<Preview, 'view' | 'setLeaves' | 'zoom' | 'setPart'>
}

/** The buttons that turn the tree to its views, hide its leaves and zoom; hidden while there is no tree. */
export function PreviewButtons({ status, preview }: Props) {
  const hidden = status.shows === 'empty' || status.webgl === 'absent'
  const { leaves } = status
  return (
    <>
      <ViewButtons
        hidden={hidden}
        view={status.view}
        hasPhoto={status.hasPhotoView}
        choose={name => preview().view(name)}
      />
      <div class="overlay view-tools" hidden={hidden}>
        <IconButton
          label={text.preview.leaves}
          icon={ICONS.leaf}
          hidden={status.shows !== 'model'}
          aria-pressed={leaves}
          onClick={() => preview().setLeaves(!leaves)}
        />
        <IconButton label={text.preview.nearer} icon={ICONS.plus} onClick={() => preview().zoom(STEP)} />
        <IconButton label={text.preview.farther} icon={ICONS.minus} onClick={() => preview().zoom(1 / STEP)} />
        <PartsMenu parts={status.parts} show={(part, shown) => preview().setPart(part, shown)} />
        <EditButton />
      </div>
    </>
  )
}

interface PartsProps {
  readonly parts: PreviewStatus['parts']
  show(part: Part, shown: boolean): void
}

/** The parts of what many photos say, each shown or hidden. */
function PartsMenu({ parts, show }: PartsProps) {
  const { group, names, branches, crown } = text.measured.parts
  const there = PARTS.filter(part => parts?.[part] !== undefined)
  return (
    <div hidden={!there.length}>
      <Popover
        opener={{ class: 'button square', 'aria-label': group, title: group, children: <Icon path={ICONS.layers} /> }}
        class="parts-menu"
        label={group}
      >
        {there.map(part => (
          <label key={part}>
            <input
              type="checkbox"
              checked={parts![part]!}
              onChange={event => show(part, event.currentTarget.checked)}
            />
            {names[part]}
          </label>
        ))}
        <p hidden={!parts?.crown}>{crown}</p>
        <p hidden={!parts?.branches}>{branches}</p>
      </Popover>
    </div>
  )
}

/** The button that begins and ends the editing of branches; hidden where no photos show any. */
function EditButton() {
  const { edits } = useStudio()
  const isOn = useStore(state => state.branchTool !== null)
  const isThere = useStore(canEdit)
  return (
    <IconButton
      label={text.measured.edits.start}
      icon={ICONS.pencil}
      hidden={!isThere}
      aria-pressed={isOn}
      onClick={() => edits.choose(isOn ? null : 'move')}
    />
  )
}

interface ViewProps {
  readonly hidden: boolean
  readonly view: PreviewStatus['view']
  readonly hasPhoto: boolean
  choose(name: View): void
}

/** The views as buttons, and as a list for where there is no room for buttons. */
function ViewButtons({ hidden, view, hasPhoto, choose }: ViewProps) {
  const isDrawing = useStore(isBareDrawing)
  const labels = { ...text.preview.view, ...(isDrawing && { photo: text.preview.drawing }) }
  return (
    <>
      <div class="overlay views" role="group" aria-label={text.preview.views} hidden={hidden}>
        {VIEWS.map(name => (
          <button
            type="button"
            class="button"
            key={name}
            aria-pressed={view === name}
            disabled={name === 'photo' && !hasPhoto}
            title={name === 'photo' && !hasPhoto ? text.measured.noCamera : undefined}
            onClick={() => choose(name)}
          >
            {labels[name]}
          </button>
        ))}
      </div>
      <select
        class="overlay view-choice"
        aria-label={text.preview.views}
        hidden={hidden}
        value={view}
        onChange={event => choose(event.currentTarget.value as View)}
      >
        <option value="free" hidden>
          {text.preview.free}
        </option>
        {VIEWS.map(name => (
          <option value={name} key={name} disabled={name === 'photo' && !hasPhoto}>
            {labels[name]}
          </option>
        ))}
      </select>
    </>
  )
}

/** The switch between the live skeleton and the grown tree; hidden unless both can be shown. */
export function ShowsSwitch({ webgl }: Pick<PreviewStatus, 'webgl'>) {
  const { store } = useStudio()
  const shows = useStore(state => state.shows)
  const hasBoth = useStore(({ liveTree, model }) => liveTree !== null && Boolean(model?.glb))
  return (
    <div class="overlay shows" role="group" aria-label={text.preview.shows} hidden={!hasBoth || webgl === 'absent'}>
      {(['live', 'model'] as const).map(choice => (
        <button
          type="button"
          class="button"
          key={choice}
          aria-pressed={shows === choice}
          onClick={() => store.set({ shows: choice })}
        >
          <span class="roomy">{text.preview.showing[choice].long}</span>
          <span class="short">{text.preview.showing[choice].short}</span>
        </button>
      ))}
    </div>
  )
}

/** The choice between the trees of a model; hidden where it has only one. */
export function VariantChoice() {
  const { grower } = useStudio()
  const count = useStore(countOf)
  const chosen = useStore(state => state.model?.variant ?? 1)
  const { group, oneOf } = text.preview.variants
  const numbers = Array.from({ length: count }, (_, at) => at + 1)
  return (
    <div class={`overlay variants ${count > MOST_BUTTONS ? 'many' : ''}`.trim()} hidden={count < 2}>
      <div class="variant-buttons" role="group" aria-label={group}>
        {numbers.map(number => (
          <button
            type="button"
            class="button square"
            key={number}
            aria-label={oneOf(number, count)}
            title={oneOf(number, count)}
            aria-pressed={number === chosen}
            onClick={() => void grower.choose(number)}
          >
            {number}
          </button>
        ))}
      </div>
      <select
        class="variant-list"
        aria-label={group}
        value={chosen}
        onChange={event => void grower.choose(Number(event.currentTarget.value))}
      >
        {numbers.map(number => (
          <option value={number} key={number}>
            {oneOf(number, count)}
          </option>
        ))}
      </select>
    </div>
  )
}

function countOf({ model }: State): number {
  return model?.glb ? variantsOf(model.info) : 0
}
