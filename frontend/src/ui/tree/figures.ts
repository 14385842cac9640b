import type { Model } from '../../api/types'
import { text } from '../../text'
import { bytes, hundredth, percent, seconds, whole } from '../../text/numbers'

/** A figure of the score card: what, how much, and what that means. */
export interface Figure {
  readonly row: keyof typeof text.score.rows
  readonly label: string
  readonly value: string
  readonly why: string
}

type Row = keyof typeof text.score.rows
interface Report {
  readonly seconds?: Readonly<Record<string, number>>
  readonly counts?: Readonly<Record<string, number>>
  readonly reading?: { readonly doubts: readonly string[] }
}

/** List the figures of a finished model; those that the service does not give are left out. */
export function figuresOfModel({ score, report }: Model): Figure[] {
  const { counts, seconds: spent } = (report ?? {}) as Report
  const share = (name: string) => shown(score?.[name], percent)
  const values: Record<Row, string | undefined> = {
    frontCovered: share('front_covered'),
    sideCovered: share('side_covered'),
    frontTrue: share('front_true'),
    sideTrue: share('side_true'),
    paired: share('paired'),
    inPlanes: share('in_planes'),
    silhouette: share('silhouette_iou'),
    reached: share('attractors_reached'),
    depth: shown(score?.depth_over_width, factor => text.score.times(hundredth(factor))),
    branches: shown(counts?.branches, whole),
    leaves: shown(counts?.leaves, whole),
    triangles: shown(counts?.triangles, whole),
    size: shown(counts?.bytes, bytes),
    time: shown(spent && sum(Object.values(spent)), seconds),
  }
  return (Object.keys(values) as Row[]).flatMap(row => {
    const [label, why] = text.score.rows[row]
    return values[row] === undefined ? [] : [{ row, label, value: values[row], why }]
  })
}

/** Return in one line how well the model fits the photo, or follows the sketches. */
export function matchOf({ score, report }: Model): string {
  const { front_covered: front, side_covered: side } = score ?? {}
  if (front !== undefined) {
    const said = percent(front)
    return side === undefined ? text.score.sketchMatch(said) : text.score.sketchesMatch(said, percent(side))
  }
  const fit = score?.silhouette_iou
  if (fit === undefined) return text.grow.status.grown
  return text.score[doubtsOf(report).length ? 'doubtful' : 'match'](percent(fit))
}

/** Return in a few words what the model is made of. */
export function makingOf(model: Model): string {
  const figure = (row: Row) => figuresOfModel(model).find(one => one.row === row)?.value
  const triangles = figure('triangles')
  return [triangles && text.score.triangles(triangles), figure('size')].filter(Boolean).join(' · ')
}

/** Return what the fit is worth, for somebody who has seen no other; where the reading is in doubt, why it is. */
export function judgementOf({ score, report }: Model): string {
  const doubts = doubtsOf(report)
  if (doubts.length) return doubts.map(code => text.score.doubts[code] ?? '').join(' ')
  const drawn = [score?.front_covered, score?.side_covered].filter(one => one !== undefined)
  if (drawn.length) return text.score.sketchWords.find(([least]) => Math.min(...drawn) >= least)?.[1] ?? ''
  const fit = score?.silhouette_iou ?? 0
  return text.score.words.find(([least]) => fit >= least)?.[1] ?? ''
}

function doubtsOf(report: Model['report']): readonly string[] {
  return ((report ?? {}) as Report).reading?.doubts ?? []
}

function shown<T>(value: T | undefined, write: (value: T) => string): string | undefined {
  return value === undefined ? undefined : write(value)
}

function sum(numbers: readonly number[]): number {
  return numbers.reduce((total, number) => total + number, 0)
}
