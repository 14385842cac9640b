import { describe, expect, test } from 'vitest'
import {
  AT_REST,
  type Down,
  type Gesture,
  type GestureEvent,
  type Intent,
  interpret,
  type Move,
} from '../../src/sketch/gesture'
import type { Line, Point } from '../../src/strokes'

const down = (id: number, at: Point, change: Partial<Down> = {}): Down => ({
  type: 'down',
  id,
  at,
  pointer: 'mouse',
  button: 0,
  contact: 1,
  tool: 'crown',
  alone: true,
  ...change,
})
const move = (id: number, path: Line, change: Partial<Move> = {}): Move => ({
  type: 'move',
  id,
  at: path.at(-1)!,
  path,
  pointer: 'mouse',
  contact: 1,
  pressed: true,
  ...change,
})
const up = (id: number, at: Point): GestureEvent => ({ type: 'up', id, at })
const finger = { pointer: 'touch', contact: 20 } as const
const second = { ...finger, alone: false } as const
const pen = { pointer: 'pen' } as const
const space = (held: boolean): GestureEvent => ({ type: 'space', held })

function play(events: readonly GestureEvent[], state: Gesture = AT_REST): { intents: Intent[]; state: Gesture } {
  let now = state
  const intents: Intent[] = []
  for (const event of events) {
    const step = interpret(now, event)
    now = step.state
    intents.push(...step.intents)
  }
  return { intents, state: now }
}
const kinds = (events: readonly GestureEvent[], state?: Gesture) => play(events, state).intents.map(({ type }) => type)

describe('drawing', () => {
  test('a left drag draws with the tool, through every coalesced point', () => {
    const { intents, state } = play([
      down(1, [10, 10]),
      move(1, [
        [14, 10],
        [30.25, 12.5],
      ]),
      up(1, [31, 13]),
    ])
    expect(intents).toEqual([
      { type: 'begin', kind: 'crown', at: [10, 10] },
      {
        type: 'extend',
        path: [
          [14, 10],
          [30.25, 12.5],
        ],
      },
      { type: 'extend', path: [[31, 13]] },
      { type: 'end' },
    ])
    expect(state).toEqual(AT_REST)
  })

  test.each(['crown', 'branch', 'select'] as const)('a right drag draws a branch, also with the tool %s', tool => {
    const { intents } = play([down(1, [0, 0], { button: 2, tool }), move(1, [[9, 9]]), up(1, [9, 9])])
    expect(intents[0]).toEqual({ type: 'begin', kind: 'branch', at: [0, 0] })
    expect(intents.at(-1)).toEqual({ type: 'end' })
  })

  test("the pen's barrel button draws a branch", () => {
    expect(play([down(4, [0, 0], { ...pen, button: 2 })]).intents[0]).toMatchObject({ type: 'begin', kind: 'branch' })
  })

  test('a tap with a tiny wiggle is a click and no stroke', () => {
    const { intents } = play([down(1, [10, 10]), move(1, [[14, 12]]), move(1, [[10, 10]]), up(1, [11, 10])])
    expect(intents.slice(-2)).toEqual([{ type: 'drop' }, { type: 'click', at: [11, 10], pointer: 'mouse' }])
  })

  test('a loop that comes back to its start is a stroke', () => {
    expect(kinds([down(1, [10, 10]), move(1, [[60, 10]]), move(1, [[10, 10]]), up(1, [10, 10])]).at(-1)).toBe('end')
  })

  test('a right click neither draws nor selects', () => {
    expect(kinds([down(1, [5, 5], { button: 2 }), up(1, [5, 5])])).toEqual(['begin', 'drop'])
  })

  test('Escape and a canceled pointer drop the stroke, and the rest of the drag does nothing', () => {
    for (const end of [{ type: 'escape' }, { type: 'cancel', id: 1 }] as const) {
      const events = [down(1, [0, 0]), move(1, [[50, 50]]), end, move(1, [[90, 90]]), up(1, [90, 90])]
      expect(kinds(events)).toEqual(['begin', 'extend', 'drop'])
    }
  })

  test('buttons beyond the third do nothing', () => {
    expect(kinds([down(1, [0, 0], { button: 3 }), move(1, [[50, 50]]), up(1, [50, 50])])).toEqual([])
  })
})

describe('pointers whose end was missed', () => {
  test('a drag goes no further once no button is down', () => {
    expect(kinds([down(1, [0, 0]), move(1, [[50, 0]]), move(1, [[80, 0]], { pressed: false })])).toEqual([
      'begin',
      'extend',
      'extend',
      'end',
    ])
  })

  test('a second press of the same pointer begins another stroke', () => {
    expect(kinds([down(1, [0, 0]), move(1, [[50, 0]]), down(1, [9, 9])])).toEqual(['begin', 'extend', 'drop', 'begin'])
  })

  test('a finger that was forgotten does not make the next one a second', () => {
    const { intents, state } = play([down(1, [0, 0], finger), move(1, [[50, 0]], finger), down(2, [9, 9], finger)])
    expect(intents.map(({ type }) => type)).toEqual(['begin', 'extend', 'drop', 'begin'])
    expect([...state.touches.keys()]).toEqual([2])
  })

  test('moves and ends of unknown pointers do nothing', () => {
    expect(play([move(7, [[1, 1]]), up(7, [1, 1]), { type: 'cancel', id: 7 }])).toEqual({
      intents: [],
      state: AT_REST,
    })
  })
})

describe('panning', () => {
  test('Space with a left drag pans and never draws, also when Space is released first', () => {
    const events = [space(true), down(1, [0, 0]), move(1, [[5, 2]]), space(false), move(1, [[9, 9]]), up(1, [9, 9])]
    expect(play(events).intents).toEqual([
      { type: 'pan', by: [5, 2] },
      { type: 'pan', by: [4, 7] },
    ])
  })

  test('the middle button pans with every tool', () => {
    expect(kinds([down(1, [0, 0], { button: 1 }), move(1, [[1, 0]]), up(1, [1, 0])])).toEqual(['pan'])
  })

  test('Space does not turn a stroke that has begun into panning', () => {
    expect(kinds([down(1, [0, 0]), space(true), move(1, [[50, 0]]), up(1, [50, 0])])).toEqual([
      'begin',
      'extend',
      'extend',
      'end',
    ])
  })

  test('the select tool clicks, and pans where the pointer moves too far for a click', () => {
    const tool = 'select'
    expect(play([down(1, [0, 0], { tool }), move(1, [[3, 0]]), up(1, [3, 0])]).intents).toEqual([
      { type: 'click', at: [3, 0], pointer: 'mouse' },
    ])
    expect(play([down(1, [0, 0], { tool }), move(1, [[3, 0]]), move(1, [[12, 0]]), up(1, [12, 0])]).intents).toEqual([
      { type: 'pan', by: [12, 0] },
    ])
  })
})

describe('fingers', () => {
  test('one finger draws', () => {
    expect(kinds([down(1, [0, 0], finger), move(1, [[50, 0]], finger), up(1, [50, 0])])).toEqual([
      'begin',
      'extend',
      'extend',
      'end',
    ])
  })

  test('a second finger drops the stroke and both pinch', () => {
    const { intents } = play([
      down(1, [100, 100], finger),
      move(1, [[130, 100]], finger),
      down(2, [230, 100], second),
      move(2, [[330, 100]], second),
    ])
    expect(intents.slice(2)).toEqual([{ type: 'drop' }, { type: 'pinch', factor: 2, about: [230, 100], by: [50, 0] }])
  })

  test('after a pinch nothing draws until all fingers are up', () => {
    const pinch = [down(1, [0, 0], finger), down(2, [100, 0], second), up(2, [100, 0])]
    expect(
      kinds([...pinch, move(1, [[9, 9]], finger), down(3, [50, 50], second), move(3, [[90, 90]], second)]),
    ).toEqual(['begin', 'drop', 'pan', 'pinch'])
    const { state } = play([...pinch, up(1, [0, 0])])
    expect(kinds([down(4, [0, 0], finger)], state)).toEqual(['begin'])
  })

  test('a third finger changes nothing', () => {
    const { state } = play([down(1, [0, 0], finger), down(2, [100, 0], second), down(3, [50, 50], second)])
    const { intents } = play([move(3, [[60, 60]], second)], state)
    expect(intents).toEqual([{ type: 'pinch', factor: 1, about: [50, 0], by: [0, 0] }])
  })

  test('fingers that touch each other do not magnify the sheet without limit', () => {
    const { state } = play([down(1, [0, 0], finger), down(2, [10, 0], second), move(2, [[0, 0]], second)])
    const [pinch] = play([move(2, [[10, 0]], second)], state).intents
    expect(pinch).toMatchObject({ factor: 10 })
  })

  test('a palm is ignored', () => {
    const palm = { ...finger, contact: 51 }
    expect(play([down(1, [0, 0], palm), move(1, [[90, 0]], palm), up(1, [90, 0])])).toEqual({
      intents: [],
      state: AT_REST,
    })
  })

  test('a finger that widens to a palm drops its stroke', () => {
    const { intents, state } = play([down(1, [0, 0], finger), move(1, [[9, 0]], { ...finger, contact: 70 })])
    expect(intents.map(({ type }) => type)).toEqual(['begin', 'drop'])
    expect(state).toEqual(AT_REST)
  })

  test('after Escape under a finger nothing draws until it is up', () => {
    const { intents, state } = play([down(1, [0, 0], finger), { type: 'escape' }, down(2, [9, 9], second)])
    expect(intents.map(({ type }) => type)).toEqual(['begin', 'drop'])
    expect(kinds([up(2, [9, 9]), up(1, [0, 0]), down(3, [0, 0], finger)], state)).toEqual(['begin'])
  })
})

describe('a pen', () => {
  const seen = play([down(9, [0, 0], pen), move(9, [[50, 0]], pen), up(9, [50, 0])]).state

  test('draws', () => {
    expect(kinds([down(9, [0, 0], pen), move(9, [[50, 0]], pen), up(9, [50, 0])])).toEqual([
      'begin',
      'extend',
      'extend',
      'end',
    ])
  })

  test('once seen, a finger pans, two pinch and none draws', () => {
    const events = [
      down(1, [0, 0], finger),
      move(1, [[20, 0]], finger),
      down(2, [100, 0], second),
      move(2, [[120, 0]], second),
    ]
    expect(kinds([...events, up(1, [20, 0]), up(2, [120, 0])], seen)).toEqual(['pan', 'pinch'])
  })

  test('that hovers is seen', () => {
    const { state } = play([move(9, [[5, 5]], { ...pen, pressed: false })])
    expect(kinds([down(1, [0, 0], finger)], state)).toEqual([])
  })

  test("once seen, a finger's tap still selects", () => {
    expect(play([down(1, [4, 4], finger), up(1, [4, 4])], seen).intents).toEqual([
      { type: 'click', at: [4, 4], pointer: 'touch' },
    ])
  })

  test('goes on drawing when a palm touches beside it, and the palm does nothing afterwards', () => {
    const events = [
      down(9, [0, 0], pen),
      down(1, [80, 80], finger),
      move(9, [[50, 0]], pen),
      move(1, [[99, 99]], finger),
      up(9, [50, 0]),
      move(1, [[140, 99]], finger),
      up(1, [140, 99]),
    ]
    const { intents, state } = play(events)
    expect(intents.map(({ type }) => type)).toEqual(['begin', 'extend', 'extend', 'end'])
    expect(state.mode).toEqual({ name: 'idle' })
  })

  test('takes over from a palm that was there first', () => {
    expect(kinds([down(1, [80, 80], finger), down(9, [0, 0], pen), move(9, [[50, 0]], pen), up(9, [50, 0])])).toEqual([
      'begin',
      'drop',
      'begin',
      'extend',
      'extend',
      'end',
    ])
  })
})
