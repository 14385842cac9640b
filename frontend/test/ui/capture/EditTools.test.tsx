// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { beforeEach, expect, test, vi } from 'vitest'
import { NO_STROKES, withPhoto } from '../../../src/strokes'
import { Studio } from '../../../src/studio/studio'
import { EditTools } from '../../../src/ui/capture/EditTools'
import { CROWN, camera, captureAnswer, captureSheets, TRUNK } from '../../builders'
import { mount } from '../mount'

let studio: Studio
let host: HTMLElement

/** The capture's unit is half a metre. */
const FRAME: ReturnType<typeof captureAnswer>['tree_from_capture'] = [
  [0.5, 0, 0, 0],
  [0, 0.5, 0, 0],
  [0, 0, 0.5, 0],
]

beforeEach(() => {
  studio = new Studio()
  // The service does not answer.
  vi.spyOn(studio.client, 'traceCapture').mockReturnValue(new Promise(() => {}))
  const drawn = withPhoto(NO_STROKES, 'a.jpg', { ...NO_STROKES, crown: CROWN, branches: [{ points: TRUNK }] })
  const history = { past: [], present: drawn, future: [] }
  studio.store.set({ history, sheets: captureSheets(['a.jpg'], { cameras: [camera('a.jpg')] }) })
  trace()
  studio.edits.choose('move')
  host = mount(studio, <EditTools />)
})

function trace(changes: Parameters<typeof captureAnswer>[0] = {}): void {
  const answer = captureAnswer({ tree_from_capture: FRAME, ...changes })
  void act(() => studio.store.set({ traced: { of: studio.store.strokes, answer } }))
}

const tools = () => host.querySelector<HTMLElement>('.edit-tools')!
const hint = () => host.querySelector('.edit-hint')!.textContent
const button = (name: string) =>
  [...host.querySelectorAll('button')].find(one => one.textContent === name || one.ariaLabel?.startsWith(name))!
const field = () => host.querySelector('input')!
const click = (name: string) => void act(() => button(name).click())

test('the tools are there while branches are edited, and only where many photos show some', () => {
  expect(tools().hidden).toBe(false)
  click('Done')
  expect(tools().hidden).toBe(true)
  void act(() => studio.store.set({ branchTool: 'move', traced: null }))
  expect(tools().hidden).toBe(true)
})

test('each tool says what to do next', () => {
  expect(hint()).toContain('Click on a branch')
  void act(() => studio.edits.picked(1))
  expect(hint()).toContain('Drag the marked joint')
  click('Add')
  expect(hint()).toContain('Draw a branch')
  click('Join')
  expect(hint()).toContain('where it belongs')
})

test('the thickness is in centimetres, whatever the capture’s unit', () => {
  expect([field().value, field().disabled]).toEqual(['', true])
  void act(() => studio.edits.picked(1))
  expect(field().value).toBe('50.0')
  field().value = '20'
  void act(() => {
    field().dispatchEvent(new Event('change'))
  })
  expect(studio.store.strokes.edits).toEqual([{ do: 'radius', at: [0, -2, 0], radius: 0.2 }])
  expect(hint()).toContain('Changing')
})

test('a branch is reached, removed and brought back by buttons alone', () => {
  expect(button('Remove').hasAttribute('disabled')).toBe(true)
  click('Towards the tip')
  click('Remove')
  expect(studio.store.strokes.edits).toEqual([{ do: 'remove', at: [0, -2, 0] }])
  click('Undo')
  expect(studio.store.strokes.edits).toBeUndefined()
})

test('Escape deselects, and then ends the editing', () => {
  const pressEscape = () =>
    void act(() => {
      dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }))
    })
  void act(() => studio.edits.picked(1))
  pressEscape()
  expect([studio.store.state.selection, tools().hidden]).toEqual([null, false])
  pressEscape()
  expect(tools().hidden).toBe(true)
})

test('an edit that was left out is told with its reason', () => {
  const status = host.querySelector<HTMLElement>('.edit-lost')!
  expect(status.hidden).toBe(true)
  const detail = 'this edit was left out: there is no branch near the place that it names'
  trace({ warnings: [{ code: 'edit_lost', stroke: 'edits/0', detail }] })
  expect(status.textContent).toBe('One edit was left out: there is no branch near the place that it names.')
})
