// @vitest-environment jsdom
import { beforeEach, expect, test, vi } from 'vitest'
import type { Branches } from '../../../src/branches'
import { type Pose, projected, VIEW_SLOPE } from '../../../src/preview/camera'
import { IDENTITY, scaling } from '../../../src/preview/capture/similarity'
import { EditLayer, type EditTool, nearestOnScreen } from '../../../src/preview/edit/editLayer'

/** A trunk up the middle, and a limb to the right and towards the eye. */
const TREE: Branches = {
  points: [
    [0, 0, 0],
    [0, 0.5, 0],
    [0, 1, 0],
    [0.4, 0.6, 0.3],
  ],
  radii: [0.03, 0.02, 0.01, 0.01],
  parents: [-1, 0, 1, 1],
  seen: [true, true, true, false],
}
const VIEWPORT = { width: 400, height: 400 }
const POSE: Pose = { target: [0, 0.5, 0], azimuth: 0, polar: Math.PI / 2, size: 1.5, slope: VIEW_SLOPE }
const place = (joint: number) => projected(POSE, TREE.points[joint]!, VIEWPORT)

let canvas: HTMLCanvasElement
let layer: EditLayer
const events = { picked: vi.fn(), moved: vi.fn(), drew: vi.fn() }
const hooks = { changed: vi.fn(), pan: vi.fn(), signal: new AbortController().signal }

beforeEach(() => {
  vi.resetAllMocks()
  const ctx = new Proxy({}, { get: () => () => {}, set: () => true })
  vi.spyOn(HTMLCanvasElement.prototype, 'getContext').mockReturnValue(ctx as never)
  const host = document.createElement('div')
  canvas = document.createElement('canvas')
  canvas.setPointerCapture = () => {}
  host.append(canvas)
  layer = new EditLayer(host, canvas, events, hooks)
})

function edit(tool: EditTool, selected: number | null = null, world = IDENTITY): void {
  layer.set({ tool, branches: TREE, selected })
  layer.draw(POSE, VIEWPORT, world)
}

function pointer(type: string, [x, y]: readonly [number, number, ...number[]]): boolean {
  const event = new MouseEvent(`pointer${type}`, { clientX: x, clientY: y, bubbles: true, cancelable: true })
  Object.assign(event, { pointerId: 1, isPrimary: true, pointerType: 'mouse' })
  return canvas.dispatchEvent(event)
}

test('a click picks the joint that it is on, and none beside the tree', () => {
  edit('move')
  layer.click([place(3)[0], place(3)[1]])
  layer.click([10, 10])
  expect(events.picked.mock.calls).toEqual([[3], [null]])
})

test('the selected joint is dragged at its own distance from the eye, others are not', () => {
  edit('move', 3)
  pointer('down', place(2))
  pointer('move', [200, 30])
  pointer('up', [200, 30])
  expect(events.moved).not.toHaveBeenCalled()
  const [x, y] = place(3)
  pointer('down', [x, y])
  pointer('move', [x + 10, y])
  pointer('move', [x + 20, y - 10])
  pointer('up', [x + 20, y - 10])
  const [joint, to] = events.moved.mock.calls[0]!
  expect(joint).toBe(3)
  expect(to[2]).toBeCloseTo(0.3, 9)
  const [shownX, shownY] = projected(POSE, to, VIEWPORT)
  expect([shownX, shownY]).toEqual([expect.closeTo(x + 20, 6), expect.closeTo(y - 10, 6)])
})

test('a branch is drawn from a joint, its points in the frame of the branches', () => {
  edit('add', null, scaling(1))
  const [x, y] = place(2)
  pointer('down', [x, y])
  for (const along of [10, 12, 25, 40]) pointer('move', [x + along, y])
  pointer('up', [x + 40, y])
  const [from, points] = events.drew.mock.calls[0]!
  expect(from).toBe(2)
  expect(points).toHaveLength(3)
  expect(points.every((point: number[]) => Math.abs(point[1]! - 1) < 1e-9 && Math.abs(point[2]!) < 1e-9)).toBe(true)
})

test('a press on a joint without a drag picks it; one beside all joints moves the photo', () => {
  edit('add')
  pointer('down', place(1))
  pointer('up', place(1))
  expect(events.picked).toHaveBeenCalledWith(1)
  pointer('down', [20, 20])
  pointer('move', [25, 32])
  pointer('up', [25, 32])
  expect(hooks.pan.mock.calls).toEqual([[5, 12]])
})

test('nothing happens once editing has ended', () => {
  edit('add')
  layer.set(null)
  pointer('down', place(1))
  pointer('move', [300, 300])
  pointer('up', [300, 300])
  expect([events.picked, events.drew, hooks.pan].some(one => one.mock.calls.length)).toBe(false)
})

test('between two joints the nearer one is meant, and before another branch the one nearer to the eye', () => {
  const joints = [
    [0, 100, 5, 1],
    [0, 0, 5, 1],
    [50, 50, 3, 1],
    [-50, 50, 3, 1],
  ] as const
  const parents = [-1, 0, -1, 2]
  expect(nearestOnScreen(joints, parents, { at: [2, 80], reach: 12 })).toBe(0)
  expect(nearestOnScreen(joints, parents, { at: [2, 20], reach: 12 })).toBe(1)
  expect(nearestOnScreen(joints, parents, { at: [-1, 50], reach: 12 })).toBe(3)
  expect(nearestOnScreen(joints, parents, { at: [30, 10], reach: 12 })).toBeNull()
})
