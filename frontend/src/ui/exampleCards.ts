import { fromWire, type Line, type Strokes } from '../strokes'
import { EXAMPLES, type Example } from '../studio/examples'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, svg } from './dom'
import { mayLeave } from './intake'

/** Make a card of every bundled example, with its two strokes over its photo. */
export function exampleCards(studio: Studio): HTMLElement {
  return el('ul', { class: 'picks' }, ...EXAMPLES.map(example => card(example, studio)))
}

function card(example: Example, studio: Studio): HTMLElement {
  const photo = el('img', { src: example.photo, alt: '', decoding: 'async' })
  const open = button({ class: 'pick' }, () => mayLeave(studio) && void studio.opener.openExample(example))
  open.append(
    el('span', { class: 'pick-photo' }, photo),
    el('span', { class: 'pick-name' }, text.examples[example.name] ?? example.name),
  )
  void overlay(example, photo, studio)
  const credit = text.credits[example.name]
  return el('li', {}, open, credit ? el('small', { class: 'credit' }, text.welcome.credit(...credit)) : null)
}

/** Lay the strokes over the photo; without them the card is good as well. */
async function overlay({ strokes }: Example, photo: HTMLImageElement, { client }: Studio): Promise<void> {
  try {
    const [file] = await Promise.all([client.getFile(strokes), photo.decode()])
    photo.after(sketched(fromWire(JSON.parse(await file.text())), photo.naturalWidth, photo.naturalHeight))
  } catch {
    return
  }
}

function sketched({ crown, branches }: Strokes, width: number, height: number): SVGElement {
  const frame = { viewBox: `0 0 ${width} ${height}`, preserveAspectRatio: 'xMidYMid slice', 'aria-hidden': 'true' }
  const drawn = (kind: string, points: Line, end = '') =>
    svg('path', { class: `pick-${kind}`, d: `M${points.map(point => point.join(' ')).join('L')}${end}` })
  const lines = branches.map(({ points }) => drawn('branch', points))
  return svg('svg', frame, ...(crown ? [drawn('crown', crown, 'z')] : []), ...lines)
}
