import { useLayoutEffect, useState } from 'preact/hooks'
import { captureOf, clipOf, photoDrawnOn } from '../../sheets'
import type { PointerKind } from '../../sketch/gesture'
import type { State } from '../../state'
import { text } from '../../text'
import { useStore, useStudio } from '../parts/useStore'
import { type Hint, hintOf } from './hint'
import './hintLine.css'

/** The hint, with buttons for what can be done about it. */
export function HintLine() {
  const pointer = usePointer()
  const hint = hintOf(
    useStore(state => state),
    pointer,
  )
  const isTracing = useStore(state => state.tracing)
  const words = useStore(tracingWords)
  return (
    <div class={isTracing ? 'hint-row is-tracing' : 'hint-row'}>
      <div class="hint-over">
        <div class="hint" data-tone={hint.tone}>
          {/* A screen reader reads an alert when it is added to the page. */}
          <p key={hint.tone} class="hint-text" role={hint.tone === 'fault' ? 'alert' : undefined}>
            <strong>{hint.text}</strong>
            {hint.how && <span class="hint-how"> {hint.how}</span>}
          </p>
          <HintActions hint={hint} />
        </div>
        <p class="hint-tracing" aria-hidden="true">
          {words}
        </p>
      </div>
    </div>
  )
}

/** Say what is being traced. */
function tracingWords(state: State): string {
  if (clipOf(state)) return text.clip.tracing
  const cameras = captureOf(state)?.cameras.length
  return cameras === undefined ? text.hints.tracing : text.capture.tracing(cameras)
}

/** Return the kind of pointer that was used last; before that, the device's main one. */
function usePointer(): PointerKind {
  const [pointer, setPointer] = useState<PointerKind>(matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse')
  useLayoutEffect(() => {
    const used = ({ pointerType }: PointerEvent) => setPointer(kindOf(pointerType))
    addEventListener('pointerdown', used)
    return () => removeEventListener('pointerdown', used)
  }, [])
  return pointer
}

/** Return the kind of a pointer; without a mouse, one that is reported as a mouse is a finger. */
function kindOf(pointerType: string): PointerKind {
  if (pointerType === 'touch' || pointerType === 'pen') return pointerType
  return matchMedia('(any-pointer: fine)').matches ? 'mouse' : 'touch'
}

function HintActions({ hint: { tone, stroke, deletes } }: { readonly hint: Hint }) {
  const { strokes, captures, tracer } = useStudio()
  const drawnOver = useStore(photoDrawnOn)
  const elsewhere = stroke?.photo !== undefined && stroke.photo !== drawnOver ? stroke.photo : null
  const removeStroke = () => {
    strokes.select(stroke!)
    strokes.remove()
  }
  return (
    <>
      {elsewhere !== null && <Action label={text.capture.hints.show} run={() => captures.choose(elsewhere)} />}
      {stroke && <Action label={text.hints.deleteStroke} run={removeStroke} />}
      {tone === 'fault' && !stroke && <Action label={text.grow.tryAgain} run={() => tracer.again()} />}
      {tone === 'fault' && <Action label={text.hints.undo} run={() => strokes.undo()} />}
      {deletes && <Action label={text.hints.delete} run={() => strokes.remove()} />}
    </>
  )
}

function Action({ label, run }: { readonly label: string; run(): void }) {
  return (
    <button type="button" class="button outlined small" onClick={run}>
      {label}
    </button>
  )
}
