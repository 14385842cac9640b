import { expect, test } from 'vitest'
import { begin } from '../../src/history'
import { EMPTY, type State } from '../../src/state'
import { withStroke } from '../../src/strokes'
import { canGrow, figuresOf, isBusy, standingOf, stepOf } from '../../src/ui/standing'
import { CROWN, model, photo, TRUNK } from '../builders'

const crown = withStroke(EMPTY.history.present, 'crown', CROWN)
const drawn = withStroke(crown, 'branch', TRUNK)
const settings = { ...EMPTY.settings }
const grown = model({ status: 'succeeded', settings, files: { 'tree.glb': '/t' } })

function state(changes: Partial<State> = {}): State {
  return { ...EMPTY, photo: photo(), history: begin(drawn), ...changes }
}

const finished = (changes: Partial<State> = {}) =>
  state({ model: grown, modelOf: drawn, tree: new ArrayBuffer(4), ...changes })

test('it says what is missing until there is a photo, a crown and a trunk', () => {
  expect(standingOf(EMPTY)).toBe('noPhoto')
  expect(standingOf(state({ history: begin(EMPTY.history.present) }))).toBe('noCrown')
  expect(standingOf(state({ history: begin(crown) }))).toBe('noTrunk')
  expect(standingOf(state())).toBe('ready')
})

test('a stroke that cannot be used keeps the tree from growing, a fault of the service does not', () => {
  const fault = { text: 'The trunk does not reach the crown.' }
  const faulty = (changes: Partial<State['faults']>) => standingOf(state({ faults: { ...EMPTY.faults, ...changes } }))
  expect(faulty({ strokes: { ...fault, stroke: { kind: 'branch', index: 0 } } })).toBe('noSense')
  expect(faulty({ strokes: fault })).toBe('ready')
})

test('a tree under way stands before everything else, even where its strokes are gone', () => {
  expect(standingOf(state({ asking: true }))).toBe('asking')
  expect(standingOf(state({ model: model() }))).toBe('queued')
  expect(standingOf(state({ model: model({ status: 'running' }), history: begin(crown) }))).toBe('growing')
})

test('a finished model is brought, and then it stands until strokes, settings or seed change', () => {
  expect(standingOf(finished({ tree: null }))).toBe('bringing')
  expect(standingOf(finished())).toBe('grown')
  expect(standingOf(finished({ modelOf: crown }))).toBe('strokesChanged')
  expect(standingOf(finished({ settings: { ...settings, leaf_size: 2 } }))).toBe('settingsChanged')
  expect(standingOf(finished({ seed: 5 }))).toBe('settingsChanged')
})

test('another leaf changes the tree, and settings of files change only its files', () => {
  const limits = { settings: { compress: { group: 'file' }, files: { group: 'file' } } } as unknown as State['limits']
  const set = (changes: Partial<State['settings']>) =>
    standingOf(finished({ limits, settings: { ...settings, ...changes } }))
  expect(standingOf(finished({ leaf: new Blob() }))).toBe('settingsChanged')
  expect(set({ files: [] })).toBe('grown')
  expect(set({ files: ['obj'], compress: true })).toBe('filesChanged')
  expect(set({ files: ['obj'], height: 12 })).toBe('settingsChanged')
})

test('a setting that an older model does not know counts as unchanged', () => {
  expect(standingOf(finished({ model: { ...grown, settings: { height: 10 } } }))).toBe('grown')
})

test('a model that failed or was canceled says so until something else is drawn', () => {
  const failed = model({ status: 'failed' })
  expect(standingOf(state({ model: failed, modelOf: drawn }))).toBe('failed')
  expect(standingOf(state({ model: model({ status: 'canceled' }), modelOf: drawn }))).toBe('canceled')
  expect(standingOf(state({ model: failed, modelOf: crown }))).toBe('ready')
})

test('Grow works where a trunk is drawn and nothing is under way', () => {
  expect((['noPhoto', 'noCrown', 'noTrunk', 'noSense', 'asking', 'queued', 'growing'] as const).some(canGrow)).toBe(
    false,
  )
  expect((['ready', 'bringing', 'grown', 'strokesChanged', 'failed', 'canceled'] as const).every(canGrow)).toBe(true)
  expect([isBusy('queued'), isBusy('bringing')]).toEqual([true, false])
})

test('places in the queue are counted as people do', () => {
  const said = (queue_position: number) => stepOf('queued', model({ queue_position }))
  expect([1, 2, 3, 4, 11, 22].map(said)).toEqual([
    'Next in the queue',
    ...['2nd', '3rd', '4th', '11th', '22nd'].map(place => `${place} in the queue`),
  ])
})

test('phases have friendly words, an unknown one its own, and a second attempt is told', () => {
  const said = (phase: string | null, attempt = 1) => stepOf('growing', model({ status: 'running', phase, attempt }))
  expect(said('grow')).toBe('Growing branches')
  expect(said('rain')).toBe('rain')
  expect(said(null)).toBe('Starting')
  expect(said('leaf', 2)).toBe('Putting on leaves, taken up again')
})

test('per cent are never ahead, and the time that is left is said where it is known', () => {
  expect(figuresOf(model({ progress: 0.999 }))).toBe('99%')
  expect(figuresOf(model({ progress: 0.4, eta_s: 3.6 }))).toBe('40% · about 4 s left')
  expect(figuresOf(model({ progress: 0.1, eta_s: 200 }))).toBe('10% · about 3 min left')
})

test('a sketch needs a trunk and no crown; another fruit is another tree', () => {
  const bare = withStroke(EMPTY.history.present, 'branch', TRUNK)
  expect(standingOf(state({ source: 'sketch', history: begin(EMPTY.history.present) }))).toBe('noFront')
  expect(standingOf(state({ source: 'sketch', history: begin(bare) }))).toBe('ready')
  expect(standingOf(finished({ fruit: new Blob(['a pear']) }))).toBe('settingsChanged')
})
