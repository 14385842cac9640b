import { expect, test } from 'vitest'
import { begin } from '../../../src/history'
import { paper } from '../../../src/sheets'
import { EMPTY, type ShownModel, type State } from '../../../src/state'
import { type Strokes, withPhoto, withStroke } from '../../../src/strokes'
import { canGrow, growthStatusOf, isBusy } from '../../../src/ui/tree/growthStatus'
import { progressOf, sentenceOf, stepOf } from '../../../src/ui/tree/growthText'
import { session } from '../../accounts'
import { CROWN, camera, captureSheets, model, photoSheets, shownModel, sketchSheets, TRUNK } from '../../builders'

const crown = withStroke(EMPTY.history.present, 'crown', CROWN)
const drawn = withStroke(crown, 'branch', TRUNK)
const settings = { ...EMPTY.settings }
const grown = { status: 'succeeded', settings, files: { 'tree.glb': '/t' } } as const

function state(changes: Partial<State> = {}): State {
  return { ...EMPTY, sheets: photoSheets(), history: begin(drawn), ...changes }
}

const finished = (changes: Partial<State> = {}, model: Partial<ShownModel> = {}) =>
  state({ model: shownModel(grown, { strokes: drawn, glb: new ArrayBuffer(4), ...model }), ...changes })

test('it says what is missing until there is a photo, a crown and a trunk', () => {
  expect(growthStatusOf(EMPTY)).toBe('noPhoto')
  expect(growthStatusOf(state({ history: begin(EMPTY.history.present) }))).toBe('noCrown')
  expect(growthStatusOf(state({ history: begin(crown) }))).toBe('noTrunk')
  expect(growthStatusOf(state())).toBe('ready')
})

test('many photos need a crown and a trunk over one of them, and their cameras', () => {
  const over = (strokes: Strokes) => withPhoto(EMPTY.history.present, '01.jpg', strokes)
  const many = (strokes: Strokes, cameras = [camera('00.jpg')]) =>
    growthStatusOf(state({ sheets: captureSheets(['00.jpg', '01.jpg'], { cameras }), history: begin(strokes) }))
  expect(many(EMPTY.history.present)).toBe('noCrown')
  expect(many(over(crown))).toBe('noTrunk')
  expect(many(over(drawn), [])).toBe('noCameras')
  expect(many(over(drawn))).toBe('ready')
})

test('a stroke that cannot be used keeps the tree from growing, a fault of the service does not', () => {
  const fault = { text: 'The trunk does not reach the crown.' }
  const faulty = (changes: Partial<State['faults']>) =>
    growthStatusOf(state({ faults: { ...EMPTY.faults, ...changes } }))
  expect(faulty({ strokes: { ...fault, stroke: { kind: 'branch', index: 0 } } })).toBe('badStroke')
  expect(faulty({ strokes: fault })).toBe('ready')
})

test('a tree under way stands before everything else, even where its strokes are gone', () => {
  expect(growthStatusOf(state({ asking: true }))).toBe('asking')
  expect(growthStatusOf(state({ model: shownModel() }))).toBe('queued')
  expect(growthStatusOf(state({ model: shownModel({ status: 'running' }), history: begin(crown) }))).toBe('growing')
})

test('a finished model is brought, and then it stands until strokes, settings or seed change', () => {
  expect(growthStatusOf(finished({}, { glb: null }))).toBe('loading')
  expect(growthStatusOf(finished())).toBe('grown')
  expect(growthStatusOf(finished({}, { strokes: crown }))).toBe('strokesChanged')
  expect(growthStatusOf(finished({ settings: { ...settings, leaf_size: 2 } }))).toBe('settingsChanged')
  expect(growthStatusOf(finished({ seed: 5 }))).toBe('settingsChanged')
})

test('another leaf changes the tree, and settings of files change only its files', () => {
  const limits = { settings: { compress: { group: 'file' }, files: { group: 'file' } } } as unknown as State['limits']
  const set = (changes: Partial<State['settings']>) =>
    growthStatusOf(finished({ limits, settings: { ...settings, ...changes } }))
  expect(growthStatusOf(finished({ leaf: new Blob() }))).toBe('settingsChanged')
  expect(set({ files: [] })).toBe('grown')
  expect(set({ files: ['obj'], compress: true })).toBe('filesChanged')
  expect(set({ files: ['obj'], height: 12 })).toBe('settingsChanged')
})

test('a setting that an older model does not know counts as unchanged', () => {
  expect(growthStatusOf(finished({}, { info: model({ ...grown, settings: { height: 10 } }) }))).toBe('grown')
})

test('a model that failed or was canceled says so until something else is drawn', () => {
  const ended = (status: 'failed' | 'canceled', strokes: Strokes) =>
    growthStatusOf(state({ model: shownModel({ status }, { strokes }) }))
  expect(ended('failed', drawn)).toBe('failed')
  expect(ended('canceled', drawn)).toBe('canceled')
  expect(ended('failed', crown)).toBe('ready')
})

test('Grow works where a trunk is drawn and nothing is under way', () => {
  expect((['noPhoto', 'noCrown', 'noTrunk', 'badStroke', 'asking', 'queued', 'growing'] as const).some(canGrow)).toBe(
    false,
  )
  expect((['ready', 'loading', 'grown', 'strokesChanged', 'failed', 'canceled'] as const).every(canGrow)).toBe(true)
  expect([isBusy('queued'), isBusy('loading')]).toEqual([true, false])
})

test('a queued tree says how many are ahead', () => {
  const said = (queue_position: number) => stepOf(state({ model: shownModel({ queue_position }) }))
  expect([1, 2, 3, 4, 11, 22].map(said)).toEqual([
    'Next in the queue',
    '1 tree is ahead in the queue',
    ...[2, 3, 10, 21].map(ahead => `${ahead} trees are ahead in the queue`),
  ])
})

test('phases have plain words, an unknown one its own, and a second attempt is told', () => {
  const said = (phase: string | null, attempt = 1) =>
    stepOf(state({ model: shownModel({ status: 'running', phase, attempt }) }))
  expect(said('grow')).toBe('Growing branches')
  expect(said('rain')).toBe('rain')
  expect(said(null)).toBe('Starting')
  expect(said('leaf', 2)).toBe('Adding leaves (attempt 2)')
})

test('per cent are never ahead, and the time that is left is said where it is known', () => {
  expect(progressOf(model({ progress: 0.999 }))).toBe('99%')
  expect(progressOf(model({ progress: 0.4, eta_s: 3.6 }))).toBe('40% · about 4 sec left')
  expect(progressOf(model({ progress: 0.1, eta_s: 200 }))).toBe('10% · about 3 min left')
})

test('a sketch needs a trunk and no crown; another fruit is another tree', () => {
  const bare = withStroke(EMPTY.history.present, 'branch', TRUNK)
  expect(growthStatusOf(state({ sheets: sketchSheets(paper()), history: begin(EMPTY.history.present) }))).toBe(
    'noFront',
  )
  expect(growthStatusOf(state({ sheets: sketchSheets(paper()), history: begin(bare) }))).toBe('ready')
  expect(growthStatusOf(finished({ fruit: new Blob(['a pear']) }))).toBe('settingsChanged')
})

test('who may look only is told why nothing can be grown, and sees what is grown as all others do', () => {
  const looking = { session: session({ read_only: true }) }
  const drawnOnly = state(looking)
  expect([growthStatusOf(drawnOnly), canGrow('looking')]).toEqual(['looking', false])
  expect(sentenceOf(drawnOnly)).toContain('a key that only reads')
  expect(growthStatusOf(finished(looking))).toBe(growthStatusOf(finished()))
})
