import { fromWire } from '../strokes'
import { EXAMPLES, type Example, SKETCH_EXAMPLES, type SketchExample } from '../studio/examples'
import { paired, sketchFrom } from '../studio/sketches'
import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el } from './dom'
import { drawnOn, drawnPair } from './drawn'
import { mayLeave } from './intake'

/** Make a card of every bundled example, with its two strokes over its photo. */
export function exampleCards(studio: Studio): HTMLElement {
  return el('ul', { class: 'picks' }, ...EXAMPLES.map(example => card(example, studio)))
}

/** Make a card of every bundled pair of sketches. */
export function sketchCards(studio: Studio): HTMLElement {
  return el('ul', { class: 'picks pairs' }, ...SKETCH_EXAMPLES.map(example => sketchCard(example, studio)))
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
    const size = { width: photo.naturalWidth, height: photo.naturalHeight }
    photo.after(drawnOn(size, fromWire(JSON.parse(await file.text()))))
  } catch {
    return
  }
}

function sketchCard(example: SketchExample, studio: Studio): HTMLElement {
  const frame = el('span', { class: 'pick-photo on-paper' })
  const open = button({ class: 'pick' }, () => mayLeave(studio) && void studio.opener.openSketches(example))
  open.append(frame, el('span', { class: 'pick-name' }, text.examples[example.name] ?? example.name))
  void draw(example, frame, studio)
  return el('li', {}, open)
}

/** Draw both sides; without them the card is good as well. */
async function draw({ front, side }: SketchExample, frame: HTMLElement, { client }: Studio): Promise<void> {
  const urls = [front, ...(side ? [side] : [])]
  if (front.endsWith('.png')) {
    frame.append(...urls.map(src => el('img', { src, alt: '', decoding: 'async' })))
    frame.classList.add('of-pictures')
    return
  }
  try {
    const files = await Promise.all(urls.map(url => client.getFile(url)))
    const [ahead, left] = await Promise.all(files.map(async file => sketchFrom(JSON.parse(await file.text()))))
    frame.append(drawnPair(ahead!.size, paired(ahead!, left ?? null).strokes, left?.size ?? null))
  } catch {
    return
  }
}
