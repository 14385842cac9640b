// @vitest-environment jsdom
import { beforeEach, expect, test } from 'vitest'
import { NOTHING_SHOWN, type Preview } from '../../src/preview/preview'
import { type WindSwitch, windSwitch } from '../../src/ui/windSwitch'

const TREE = { ...NOTHING_SHOWN, shows: 'model', winds: ['breeze', 'gust'], wind: null } as const
let blown: (string | null)[]
let settings: number
let made: WindSwitch
const winds = () => [...made.element.querySelectorAll<HTMLElement>('.winds button')]
const pressed = () =>
  winds()
    .filter(one => one.getAttribute('aria-pressed') === 'true')
    .map(one => one.textContent)
const hidden = () => ['.winds', '.no-wind'].map(name => made.element.querySelector<HTMLElement>(name)!.hidden)

beforeEach(() => {
  blown = []
  settings = 0
  const preview = { blow: (wind: string | null) => blown.push(wind) } as unknown as Preview
  made = windSwitch(
    () => preview,
    () => settings++,
  )
})

test('a file with wind has a button for each, and one for none', () => {
  made.show(TREE)
  expect([winds().map(one => one.textContent), pressed(), hidden()]).toEqual([
    ['Still', 'Breeze', 'Gust'],
    ['Still'],
    [false, true],
  ])
  for (const one of winds()) one.click()
  expect(blown).toEqual([null, 'breeze', 'gust'])
  made.show({ ...TREE, wind: 'gust' })
  expect(pressed()).toEqual(['Gust'])
})

test('a file without wind shows the way to the settings instead', () => {
  made.show({ ...TREE, winds: [] })
  expect(hidden()).toEqual([true, false])
  made.element.querySelector<HTMLElement>('.no-wind button')!.click()
  expect(settings).toBe(1)
})

test('where no tree is shown there is neither', () => {
  made.show({ ...TREE, shows: 'live', winds: [] })
  expect(hidden()).toEqual([true, true])
})
