// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { beforeEach, expect, test } from 'vitest'
import { NOTHING_SHOWN, type PreviewStatus } from '../../../src/preview/status'
import { Studio } from '../../../src/studio/studio'
import { AnimationSwitch } from '../../../src/ui/tree/AnimationSwitch'
import { mount, redraw } from '../mount'

const TREE = { ...NOTHING_SHOWN, shows: 'model', animations: ['breeze', 'gust'], animation: null } as const
let played: (string | null)[]
let settings: number
let host: HTMLElement
const studio = new Studio()
const buttons = () => [...host.querySelectorAll<HTMLElement>('.animation-buttons button')]
const pressed = () =>
  buttons()
    .filter(one => one.getAttribute('aria-pressed') === 'true')
    .map(one => one.textContent)
const hidden = () => ['.animation-buttons', '.no-wind'].map(name => host.querySelector<HTMLElement>(name)!.hidden)

function show(status: PreviewStatus): void {
  const preview = { setAnimation: (name: string | null) => played.push(name) }
  redraw(host, studio, <AnimationSwitch status={status} preview={() => preview} toSettings={() => settings++} />)
}

beforeEach(() => {
  played = []
  settings = 0
  host = mount(studio, null)
})

test('a file with wind has a button for each, and one for none', () => {
  show(TREE)
  expect([buttons().map(one => one.textContent), pressed(), hidden()]).toEqual([
    ['Still', 'Breeze', 'Gust'],
    ['Still'],
    [false, true],
  ])
  for (const one of buttons()) one.click()
  expect(played).toEqual([null, 'breeze', 'gust'])
  show({ ...TREE, animation: 'gust' })
  expect(pressed()).toEqual(['Gust'])
})

test('a file without wind leads to the settings instead', () => {
  show({ ...TREE, animations: [] })
  expect(hidden()).toEqual([true, false])
  host.querySelector<HTMLElement>('.no-wind button')!.click()
  expect(settings).toBe(1)
})

test('where no tree is shown there is neither', () => {
  show({ ...TREE, shows: 'live', animations: [] })
  expect(hidden()).toEqual([true, true])
})
