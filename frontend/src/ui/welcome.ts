import type { Studio } from '../studio/studio'
import { text } from '../text'
import { button, el, icon } from './dom'
import { draftCards } from './drafts'
import { exampleCards, sketchCards } from './exampleCards'
import { grownTrees } from './grownTrees'
import { ICONS } from './icons'
import { illustration } from './illustration'
import { choose, chooseSketch, mayLeave, openSketch } from './intake'
import './welcome.css'

/** Lay out what is seen while no photo is open: what this is, and every way to begin. */
export function mountWelcome(studio: Studio, main: HTMLElement): void {
  const { store } = studio
  const drafts = draftCards(studio)
  const trees = grownTrees(studio)
  const welcome = el('div', { class: 'welcome' }, hero(studio), drafts.section, ...examples(studio), trees.section)
  main.append(welcome)
  store.watch(
    state => state.photo === null,
    closed => {
      welcome.hidden = !closed
      if (closed) void Promise.all([drafts.show(), trees.show()])
    },
  )
}

function hero(studio: Studio): HTMLElement {
  const begin = button(
    { class: 'button chief hero-choose' },
    () => choose(studio),
    icon(ICONS.photo),
    text.welcome.choose,
  )
  const draw = button(
    { class: 'button outlined hero-draw' },
    () => mayLeave(studio) && void studio.opener.openPaper(),
    icon(ICONS.sheet),
    text.sheets.welcome.draw,
  )
  const bring = button(
    { class: 'button outlined hero-draw' },
    () => chooseSketch(file => openSketch(studio, file)),
    icon(ICONS.drawing),
    text.sheets.openDrawing,
  )
  const fault = el('p', { class: 'fault', role: 'alert', hidden: true })
  studio.store.watch(
    state => state.faults.photo,
    now => {
      fault.hidden = !now
      fault.textContent = now?.text ?? ''
    },
  )
  const words = el(
    'div',
    { class: 'hero-words' },
    el('h1', {}, ...phrases()),
    lead(),
    el('div', { class: 'hero-begin' }, begin, el('span', { class: 'hero-other' }, text.welcome.otherWays)),
    el('div', { class: 'hero-begin' }, draw, bring, el('span', { class: 'soft' }, text.sheets.welcome.drawHint)),
    fault,
    el('p', { class: 'soft' }, text.welcome.takes),
  )
  return el('section', { class: 'hero' }, words, el('div', { class: 'hero-art' }, illustration()))
}

function phrases(): (Node | string)[] {
  return text.welcome.title.flatMap(phrase => [el('span', { class: 'phrase' }, phrase), ' '])
}

function lead(): HTMLElement {
  const { before, leaves, between, trunk, after } = text.welcome.lead
  const named = (kind: string, words: string) => el('span', { class: `lead-${kind}` }, words)
  return el('p', { class: 'lead' }, before, named('leaves', leaves), between, named('trunk', trunk), after)
}

function examples(studio: Studio): HTMLElement[] {
  const { welcome, sheets } = text
  return [
    shelf('examples', [welcome.examples, welcome.examplesHint], exampleCards(studio)),
    shelf('sketches', [sheets.welcome.examples, sheets.welcome.examplesHint], sketchCards(studio)),
  ]
}

function shelf(id: string, [title, hint]: readonly [string, string], cards: HTMLElement): HTMLElement {
  const head = el('div', { class: 'shelf-head' }, el('h2', { id }, title), el('p', { class: 'soft' }, hint))
  return el('section', { class: 'shelf', 'aria-labelledby': id }, head, cards)
}
