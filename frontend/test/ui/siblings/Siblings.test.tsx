// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { Siblings } from '../../../src/ui/siblings/Siblings'
import { SiblingsPanel } from '../../../src/ui/siblings/SiblingsPanel'
import { photoSheets, shownModel } from '../../builders'
import { settle } from '../../service'
import { mount } from '../mount'

vi.mock('../../../src/ui/siblings/portraits', () => ({ portraitOf: async (url: string) => `picture:${url}` }))

let studio: Studio
let host: HTMLElement
const click = (name: string) => {
  const button = [...host.querySelectorAll<HTMLElement>('button')].find(one => one.textContent === name)
  void act(() => button!.click())
}

function open(files: Record<string, string>) {
  studio = new Studio()
  const model = shownModel({ id: 'mdl_1', status: 'succeeded', files }, { glb: new ArrayBuffer(4) })
  const history = { past: [], future: [], present: { ...model.strokes, crown: [], branches: [{ points: [] }] } }
  studio.store.set({ sheets: photoSheets(), history, model: { ...model, strokes: history.present } } as never)
  host = mount(studio, <Siblings />)
}

beforeEach(() => vi.stubGlobal('matchMedia', () => ({ matches: false })))

test('a tree without siblings has some grown, as many and in the outline that was chosen', () => {
  open({ 'tree.glb': '/tree.glb' })
  const grow = vi.spyOn(studio.grower, 'growSiblings').mockResolvedValue()
  click('Heart')
  click('Grow 6 siblings')
  expect(grow).toHaveBeenCalledWith({ count: 6, seed: 0, scene: true, envelope: 'heart' })
})

test('an outline that is to be drawn is waited for', () => {
  open({ 'tree.glb': '/tree.glb' })
  const grow = vi.spyOn(studio.grower, 'growSiblings').mockResolvedValue()
  click('Drawn')
  click('Grow 6 siblings')
  expect(grow).not.toHaveBeenCalled()
  expect(host.querySelector('.outline-pad svg')).not.toBeNull()
})

test('what was chosen stays while siblings grow', async () => {
  open({ 'tree.glb': '/tree.glb' })
  host = mount(studio, <SiblingsPanel />)
  await vi.waitFor(() => expect(host.querySelector('.siblings-order')).not.toBeNull())
  click('Drawn')
  const { model } = studio.store.state
  void act(() => studio.store.set({ model: { ...model!, info: { ...model!.info, status: 'running' } } }))
  expect(host.querySelector('.outline-pad svg')).not.toBeNull()
})

test('each sibling has a picture, is shown by a click, and can be downloaded', async () => {
  open({ 'tree.glb': '/tree.glb', 'tree.s1.glb': '/1.glb', 'tree.s2.glb': '/2.glb', 'tree.grove.glb': '/grove.glb' })
  await act(settle)
  const cards = [...host.querySelectorAll('.sibling-card')]
  expect(cards.map(card => card.textContent)).toEqual(['The tree', 'Sibling 1', 'Sibling 2'])
  expect(cards.map(card => card.querySelector('a')!.getAttribute('href'))).toEqual(['/tree.glb', '/1.glb', '/2.glb'])
  expect(cards[1]!.querySelector('img')!.getAttribute('src')).toBe('picture:/1.glb')
  const choose = vi.spyOn(studio.grower, 'choose').mockResolvedValue()
  cards[2]!.querySelector('button')!.click()
  expect(choose).toHaveBeenCalledWith(1, 2)
  expect(host.querySelector('.sibling-actions a')!.getAttribute('href')).toBe('/grove.glb')
  click('Walk through a grove')
  expect(studio.store.state.dialog).toBe('grove')
})
