import { isSolving } from '../../api/follow'
import type { CaptureState } from '../../api/types'
import { captureOf } from '../../sheets'
import type { State } from '../../state'
import { text } from '../../text'
import { percent } from '../../text/numbers'

/** What can be done about how far many photos are. */
export type CaptureStep = 'chooseAgain' | 'goOn' | 'more' | 'solve' | 'again' | 'cancel' | 'advice'

/** How far many photos of a tree are, as the page says it. */
export interface CaptureProgress {
  readonly words: string
  /** How much of it is done, 0 to 1; absent while nothing is under way. */
  readonly done?: number
  /** What is under way, for the bar. */
  readonly label?: string
  readonly isFault?: true
  readonly steps: readonly CaptureStep[]
}

const { status } = text.capture
const FEWEST = 5

/** Return how far many photos are; null where the tree has another source. */
export function captureProgress(state: State): CaptureProgress | null {
  const capture = captureOf(state)
  if (!capture) return null
  const { photos, chosen } = capture
  const least = state.limits?.capture_photos_min ?? FEWEST
  if (capture.id === null) return { words: status.lost, isFault: true, steps: ['chooseAgain'] }
  if (state.sending) return sendingOf(state, photos.length, chosen)
  if (isSolving(state.solve)) return solvingOf(state.solve!, state.online)
  if (photos.length < chosen)
    return {
      words: status.missing(photos.length, chosen),
      steps: photos.length < least ? ['chooseAgain'] : ['chooseAgain', 'goOn'],
    }
  if (photos.length < least)
    return { words: status.tooFew(photos.length, least), isFault: true, steps: ['more', 'advice'] }
  return endOf(state, photos.filter(({ used }) => used).length, photos.length)
}

function sendingOf({ online }: State, have: number, chosen: number): CaptureProgress {
  const words = online ? status.sending(Math.min(have + 1, chosen), chosen) : text.progress.offline
  return { words, done: have / Math.max(chosen, 1), label: status.sendingProgress, steps: [] }
}

function solvingOf(solve: CaptureState, online: boolean): CaptureProgress {
  const words = online ? solveWords(solve) : text.progress.offline
  return { words, done: solve.progress, label: status.progress, steps: ['cancel'] }
}

function solveWords({ status: now, queue_position: place, phase, progress, eta_s: left }: CaptureState): string {
  if (now === 'queued') return place !== null && place > 1 ? status.ahead(place - 1) : status.queued
  const step = phase === null ? text.progress.starting : (status.phases[phase] ?? phase)
  const share = Math.floor(progress * 100) / 100
  const far = left === null || left < 1 ? percent(share) : text.progress.percentAndTime(share, left)
  return `${step} · ${far}`
}

function endOf({ solve, faults }: State, used: number, count: number): CaptureProgress {
  if (faults.capture) return { words: faults.capture.text, isFault: true, steps: ['again'] }
  if (solve?.status === 'failed') {
    const words = solve.error?.detail ?? status.unsolved
    return { words, isFault: true, steps: solve.error?.retryable ? ['again', 'more'] : ['more', 'advice'] }
  }
  if (solve?.status !== 'solved') return { words: status.unsolved, steps: ['solve'] }
  return { words: used === count ? status.allUsed(count) : status.used(used, count), steps: ['more'] }
}
