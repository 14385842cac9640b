// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { expect, test, vi } from 'vitest'
import { NOTHING_SHOWN, type PreviewStatus } from '../../../src/preview/status'
import { paper } from '../../../src/sheets'
import { Studio } from '../../../src/studio/studio'
import { PreviewButtons, ShowsSwitch, VariantChoice } from '../../../src/ui/tree/PreviewButtons'
import { grown, shownModel, sketchSheets } from '../../builders'
import { mount, redraw } from '../mount'

function choiceOf(count: number) {
  const names = Array.from({ length: count }, (_, at) => (at ? `tree.v${at + 1}.glb` : 'tree.glb'))
  const studio = new Studio()
  const choose = vi.spyOn(studio.grower, 'choose').mockResolvedValue()
  const files = Object.fromEntries(names.map(name => [name, `/${name}`]))
  studio.store.set({ model: shownModel({ status: 'succeeded', files }, { glb: new ArrayBuffer(4) }) })
  const element = mount(studio, <VariantChoice />).querySelector<HTMLElement>('.variants')!
  return { element, choose, studio, buttons: [...element.querySelectorAll('button')] }
}

test('a single tree leaves nothing to choose', () => {
  expect(choiceOf(1).element.hidden).toBe(true)
})

test('each of several trees has a number, the one that is looked at is marked', () => {
  const { element, buttons, choose, studio } = choiceOf(3)
  expect([element.hidden, buttons.map(one => one.textContent)]).toEqual([false, ['1', '2', '3']])
  buttons[1]!.click()
  expect(choose).toHaveBeenCalledWith(2)
  void act(() => studio.store.setModel('mdl_1', { variant: 2 }))
  expect(buttons.map(one => one.getAttribute('aria-pressed'))).toEqual(['false', 'true', 'false'])
})

test('many trees are chosen from a list', () => {
  const { element, choose } = choiceOf(9)
  expect(element.classList.contains('many')).toBe(true)
  const list = element.querySelector('select')!
  list.value = '7'
  list.dispatchEvent(new Event('change'))
  expect([list.options.length, choose.mock.calls]).toEqual([9, [[7]]])
})

const preview = { view: () => {}, setLeaves: () => {}, setPart: () => {}, zoom: () => {} }
const studio = new Studio()

test('live skeleton and grown tree can be switched where there are both', () => {
  const both = new Studio()
  const shows = (webgl: PreviewStatus['webgl'] = 'ok') =>
    mount(both, <ShowsSwitch webgl={webgl} />).querySelector<HTMLElement>('.shows')!
  both.store.set({ liveTree: grown() })
  expect(shows().hidden).toBe(true)
  both.store.set({ model: shownModel({ status: 'succeeded' }, { glb: new ArrayBuffer(4) }), shows: 'model' })
  expect(shows('absent').hidden).toBe(true)
  const buttons = [...shows().querySelectorAll('button')]
  expect(buttons.map(one => one.getAttribute('aria-pressed'))).toEqual(['false', 'true'])
  void act(() => buttons[0]!.click())
  expect([both.store.state.shows, buttons.map(one => one.getAttribute('aria-pressed'))]).toEqual([
    'live',
    ['true', 'false'],
  ])
})

test('views and tools are hidden without a tree; the first view is named after what lies under it', () => {
  const host = mount(studio, null)
  const status = { ...NOTHING_SHOWN, shows: 'live', view: 'side' } as const
  const tools = (shown: PreviewStatus) =>
    redraw(
      host,
      studio,
      <PreviewButtons status={shown} preview={() => ({ ...preview, view: name => seen.push(name) })} />,
    )
  const seen: string[] = []
  tools(NOTHING_SHOWN)
  expect([...host.querySelectorAll<HTMLElement>('.overlay')].map(one => one.hidden)).toEqual([true, true, true])
  tools(status)
  const views = [...host.querySelectorAll<HTMLElement>('.views button')]
  expect(views.map(one => [one.textContent, one.getAttribute('aria-pressed')])).toEqual([
    ...[
      ['Photo', 'false'],
      ['Front', 'false'],
      ['Side', 'true'],
      ['Back', 'false'],
      ['Top', 'false'],
    ],
  ])
  expect(host.querySelector('select')!.value).toBe('side')
  views[4]!.click()
  expect(seen).toEqual(['top'])
  void act(() => studio.store.set({ sheets: sketchSheets(paper()) }))
  expect(views[0]!.textContent).toBe('Drawing')
})
