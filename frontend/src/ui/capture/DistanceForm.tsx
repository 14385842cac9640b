import type { TargetedSubmitEvent } from 'preact'
import { useRef, useState } from 'preact/hooks'
import { captureOf } from '../../sheets'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { numberIn } from '../parts/spans'
import { useStore, useStudio } from '../parts/useStore'

const { distance: words } = text.capture
/** The distances that can be entered, metres. */
const SPAN = { min: 0.001, max: 1000, whole: false }

/** A button that opens the form for the distance between two photos; hidden until their cameras are known. */
export function DistanceForm() {
  const { strokes } = useStudio()
  const cameras = useStore(state => captureOf(state)?.cameras ?? [])
  const distance = useStore(({ history }) => history.present.distance)
  const [wrong, setWrong] = useState('')
  const panel = useRef<HTMLDivElement>(null)
  const names = cameras.map(({ photo }) => photo)
  if (names.length < 2) return null
  const submit = (event: TargetedSubmitEvent<HTMLFormElement>) => {
    event.preventDefault()
    const form = new FormData(event.currentTarget)
    const [from, to] = [String(form.get('from')), String(form.get('to'))]
    const metres = numberIn(String(form.get('metres')).replace(',', '.'), SPAN)
    setWrong(from === to ? words.same : metres === null ? words.wrong : '')
    if (from === to || metres === null) return
    strokes.setDistance({ photos: [from, to], metres })
    panel.current!.hidePopover()
  }
  const [from, to] = distance?.photos ?? [names[0]!, names[1]!]
  const opener = {
    class: 'button outlined small distance-opener',
    title: words.why,
    'aria-label': distance ? words.now(from, to, distance.metres) : words.open,
    children: <Icon path={ICONS.scale} />,
  }
  return (
    <Popover opener={opener} class="distance-form" label={words.open} panelRef={panel}>
      <form onSubmit={submit} key={`${from} ${to} ${distance?.metres}`}>
        <p>{words.why}</p>
        <div class="distance-fields">
          <PhotoChoice name="from" label={words.from} names={names} chosen={from} />
          <PhotoChoice name="to" label={words.to} names={names} chosen={to} />
          <label>
            {words.metres}
            <input name="metres" type="text" inputMode="decimal" autocomplete="off" defaultValue={distance?.metres} />
          </label>
        </div>
        <p class="fault" role="alert" hidden={!wrong}>
          {wrong}
        </p>
        <div class="distance-actions">
          <button type="submit" class="button primary">
            {words.set}
          </button>
          <button type="button" class="button outlined" hidden={!distance} onClick={() => strokes.setDistance(null)}>
            {words.remove}
          </button>
        </div>
      </form>
    </Popover>
  )
}

interface ChoiceProps {
  readonly name: string
  readonly label: string
  readonly names: readonly string[]
  readonly chosen: string
}

function PhotoChoice({ name, label, names, chosen }: ChoiceProps) {
  return (
    <label>
      {label}
      <select name={name}>
        {names.map(photo => (
          <option key={photo} value={photo} selected={photo === chosen}>
            {photo}
          </option>
        ))}
      </select>
    </label>
  )
}
