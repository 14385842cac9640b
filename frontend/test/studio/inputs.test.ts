import { expect, test } from 'vitest'
import { Client } from '../../src/api/client'
import { begin } from '../../src/history'
import { paper } from '../../src/sheets'
import { EMPTY, type State } from '../../src/state'
import { NO_STROKES, withSheet, withStroke } from '../../src/strokes'
import { canTrace, inputsOf, traced } from '../../src/studio/inputs'
import { answer, CROWN, LIMB, photo, photoSheets, sketchAnswer, sketchSheets, TRUNK } from '../builders'
import { service } from '../service'

const trunk = withStroke(NO_STROKES, 'branch', TRUNK)
const crowned = { ...trunk, crown: CROWN }
const both = withSheet(trunk, 'side', withStroke(NO_STROKES, 'branch', LIMB, 7))
const sketched: State = { ...EMPTY, sheets: sketchSheets(paper(), paper(600)), history: begin(both) }
const overPhoto: State = { ...EMPTY, sheets: photoSheets(), history: begin(crowned) }
const SIDE = { canvas: [450, 600], branches: [{ points: LIMB, width: 7 }] }

test('two sketches make a tree, each with the size of its paper; a photo under the front goes with them', () => {
  const front = { canvas: [900, 1200], branches: [{ points: TRUNK }] }
  expect(inputsOf(sketched)).toEqual({ sketches: { front, side: SIDE } })
  expect(inputsOf({ ...sketched, sheets: sketchSheets(photo(), paper(600)) })).toMatchObject({ photo: 'pho_1' })
})

test('a front alone is enough, a side alone is not', () => {
  expect(inputsOf({ ...sketched, history: begin(trunk) })?.sketches).not.toHaveProperty('side')
  const sideOnly = withSheet(NO_STROKES, 'side', trunk)
  expect(inputsOf({ ...sketched, history: begin(sideOnly) })).toBeNull()
})

test('a side goes with the strokes over a photo while its sheet is open', () => {
  const sheets = photoSheets(photo(), paper(600))
  const drawn = withSheet(crowned, 'side', withStroke(NO_STROKES, 'branch', LIMB, 7))
  const history = begin(drawn)
  expect(inputsOf({ sheets, history })).toEqual({ photo: 'pho_1', strokes: crowned, sketches: { side: SIDE } })
  expect(inputsOf(overPhoto)).toEqual({ photo: 'pho_1', strokes: crowned })
  expect(inputsOf({ sheets: photoSheets(), history })).toEqual({ photo: 'pho_1', strokes: crowned })
})

test('a photo is traced from its crown on, paper from its first branch on', () => {
  expect(canTrace(overPhoto)).toBe(true)
  expect(canTrace({ ...overPhoto, history: begin(trunk) })).toBe(false)
  expect(canTrace(sketched)).toBe(true)
  expect(canTrace({ ...sketched, history: begin({ ...NO_STROKES, crown: CROWN }) })).toBe(false)
})

test('traced sketches have the form of traced photos, with the crowns of both sheets', async () => {
  const warnings = [{ code: 'side_assumed', stroke: 'side', detail: '' }]
  const calls = service(() => Response.json(sketchAnswer({ warnings })))
  const found = await traced(new Client(), sketched, true)
  expect(calls[0]).toMatchObject({ path: '/v1/sketches/trace', body: { grow: true, side: SIDE } })
  expect(found).toMatchObject({
    answer: { skeleton: answer().skeleton, warnings, foliage: [] },
    crowns: { front: [[20, 10]] },
  })
})

test('the live tree over a photo grows by the settings of its branches, and one that is sketched by defaults', async () => {
  const calls = service(call => Response.json(call.path.includes('photos') ? answer() : sketchAnswer()))
  const settings = { ...EMPTY.settings, form: 'vase', wind: 'all' } as const
  for (const state of [overPhoto, sketched]) await traced(new Client(), { ...state, settings }, true)
  await traced(new Client(), { ...overPhoto, settings }, false)
  expect(calls[0]!.body.settings).toMatchObject({ form: 'vase', foliage: 'auto' })
  expect(calls[0]!.body.settings).not.toHaveProperty('wind')
  expect([calls[1]!.body.settings, calls[2]!.body.settings]).toEqual([undefined, undefined])
})
