import type { Model } from '../../api/types'
import { text } from '../../text'

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

const { score: sketched } = text.sheets
const whole = new Intl.NumberFormat('en', { maximumFractionDigits: 0 })
const percent = new Intl.NumberFormat('en', { style: 'percent', maximumFractionDigits: 0 })

/** List the figures of a finished model; those that the service does not give are left out. */
export function figuresOfModel({ score, report }: Model): Figure[] {
  const { counts, seconds } = (report ?? {}) as Report
  const share = (name: string) => shown(score?.[name], one => percent.format(one))
  const values: Record<Row, string | undefined> = {
    frontCovered: share('front_covered'),
    sideCovered: share('side_covered'),
    frontTrue: share('front_true'),
    sideTrue: share('side_true'),
    paired: share('paired'),
    inPlanes: share('in_planes'),
    silhouette: share('silhouette_iou'),
    reached: share('attractors_reached'),
    depth: shown(score?.depth_over_width, factor => text.score.times(factor.toFixed(2))),
    branches: shown(counts?.branches, number => whole.format(number)),
    leaves: shown(counts?.leaves, number => whole.format(number)),
    triangles: shown(counts?.triangles, number => whole.format(number)),
    size: shown(counts?.bytes, sizeOf),
    time: shown(seconds && sum(Object.values(seconds)), time => text.score.seconds(time.toFixed(1))),
  }
  return (Object.keys(values) as Row[]).flatMap(row => {
    const [label, why] = text.score.rows[row]
    return values[row] === undefined ? [] : [{ row, label, value: values[row], why }]
  })
}

/** Say in one line how well the model fits the photo, or goes where it was sketched. */
export function matchOf({ score, report }: Model): string {
  const { front_covered: front, side_covered: side } = score ?? {}
  if (front !== undefined) {
    const said = percent.format(front)
    return side === undefined ? sketched.match(said) : sketched.matchBoth(said, percent.format(side))
  }
  const fit = score?.silhouette_iou
  if (fit === undefined) return text.grow.status.grown
  return text.score[doubtsOf(report).length ? 'doubtful' : 'match'](percent.format(fit))
}

/** Say in a few words what the model is made of. */
export function makingOf(model: Model): string {
  const figure = (row: Row) => figuresOfModel(model).find(one => one.row === row)?.value
  const triangles = figure('triangles')
  return [triangles && text.score.triangles(triangles), figure('size')].filter(Boolean).join(' · ')
}

/** Judge the fit, for somebody who has seen no other; where the reading is in doubt, say why instead. */
export function judgementOf({ score, report }: Model): string {
  const doubts = doubtsOf(report)
  if (doubts.length) return doubts.map(code => text.score.doubts[code] ?? '').join(' ')
  const drawn = [score?.front_covered, score?.side_covered].filter(one => one !== undefined)
  if (drawn.length) return sketched.words.find(([least]) => Math.min(...drawn) >= least)?.[1] ?? ''
  const fit = score?.silhouette_iou ?? 0
  return text.score.words.find(([least]) => fit >= least)?.[1] ?? ''
}

function doubtsOf(report: Model['report']): readonly string[] {
  return ((report ?? {}) as Report).reading?.doubts ?? []
}

/** Write a number of bytes. */
export function sizeOf(bytes: number): string {
  return bytes < 1e6 ? `${whole.format(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`
}

function shown<T>(value: T | undefined, write: (value: T) => string): string | undefined {
  return value === undefined ? undefined : write(value)
}

function sum(numbers: readonly number[]): number {
  return numbers.reduce((total, number) => total + number, 0)
}
