import type { Studio } from '../../studio/studio'
import { text } from '../../text'
import { chooseMore } from '../parts/files'
import { useStore, useStudio } from '../parts/useStore'
import { type CaptureStep, captureProgress } from './captureStatus'
import { DistanceForm } from './DistanceForm'

/** The line above the strip: how far the photos are, and what can be done about it. */
export function CaptureStatus() {
  const studio = useStudio()
  const state = useStore(captureProgress)
  if (!state) return null
  const { words, done, label, isFault, steps } = state
  return (
    <div class="capture-status">
      {done !== undefined && (
        <div
          class="capture-progress"
          role="progressbar"
          aria-label={label}
          aria-valuenow={Math.floor(done * 100)}
          style={{ '--done': String(done) }}
        />
      )}
      <p class={isFault ? 'capture-words fault' : 'capture-words'} role={isFault ? 'alert' : undefined}>
        {words}
      </p>
      {steps.map(step => (
        <button key={step} type="button" class="button outlined small" onClick={() => take(studio, step)}>
          {text.capture.status[step]}
        </button>
      ))}
      <DistanceForm />
    </div>
  )
}

function take(studio: Studio, step: CaptureStep): void {
  const { captures, store } = studio
  const actions: Readonly<Record<CaptureStep, () => unknown>> = {
    chooseAgain: () => chooseMore(studio),
    goOn: () => captures.leaveOut(),
    more: () => chooseMore(studio),
    solve: () => captures.solve(),
    again: () => captures.solve(),
    cancel: () => captures.cancel(),
    advice: () => store.set({ dialog: 'advice' }),
  }
  actions[step]()
}
