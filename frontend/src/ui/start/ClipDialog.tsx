import { useEffect, useMemo, useState } from 'preact/hooks'
import type { State } from '../../state'
import { text } from '../../text'
import { chooseVideo, mayLeave, offerVideo } from '../parts/files'
import { useStore, useStudio } from '../parts/useStore'
import { Dialog } from './Dialog'
import './clipDialog.css'

const { offer: words } = text.clip
const CLOSED = { dialog: null, clipOffer: null }

/** Says what becomes of a video before it is sent, and then how far that is. */
export function ClipDialog() {
  const { clips } = useStudio()
  const file = useStore(state => state.clipOffer)
  // However it is closed, nothing goes on being sent behind the page.
  useEffect(() => () => clips.stop(), [clips])
  if (!file) return null
  return (
    <Dialog title={words.title} class="clip-dialog" after={CLOSED}>
      <Offered key={file} file={file} />
    </Dialog>
  )
}

function Offered({ file }: { readonly file: File }) {
  const studio = useStudio()
  const { opener, store } = studio
  const sent = useStore(state => state.sent)
  const fault = useStore(({ faults }) => faults.photo?.text)
  const start = async () => {
    if (!mayLeave(studio)) return
    await opener.openClip(file)
    if (!store.state.faults.photo && store.state.clipOffer === file) store.set(CLOSED)
  }
  return (
    <>
      <LocalVideo file={file} />
      <p class="soft">{words.file(file.name, file.size)}</p>
      {fault ? (
        <p class="fault" role="alert">
          {fault}
        </p>
      ) : (
        <div>
          <p>{words.what}</p>
          <p class="soft">{words.how}</p>
        </div>
      )}
      {sent === null ? <Choices fault={fault} start={start} /> : <Sending />}
    </>
  )
}

interface ChoicesProps {
  readonly fault: string | undefined
  start(): void
}

function Choices({ fault, start }: ChoicesProps) {
  const studio = useStudio()
  return (
    <div class="clip-start">
      <button type="button" class={fault ? 'button outlined' : 'button primary'} onClick={start}>
        {fault ? text.grow.tryAgain : words.start}
      </button>
      <button type="button" class="button outlined" onClick={() => chooseVideo(file => offerVideo(studio, file))}>
        {words.other}
      </button>
      <button type="button" class="button many-advice" onClick={() => studio.store.set({ dialog: 'filming' })}>
        {text.clip.welcome.advice}
      </button>
    </div>
  )
}

/** How much has been sent. */
function Sending() {
  const { clips, store } = useStudio()
  const sentence = useStore(sentenceOf)
  const sent = useStore(state => state.sent ?? 0)
  const cancel = () => {
    clips.stop()
    store.set(CLOSED)
  }
  return (
    <div class="clip-sending">
      <p role="status">{sentence}</p>
      <progress aria-label={words.progress} value={sent} max={1} />
      <button type="button" class="button outlined" onClick={cancel}>
        {words.cancel}
      </button>
    </div>
  )
}

function sentenceOf({ sent, online }: State): string {
  if (!online) return words.offline
  return sent === 1 ? words.reading : words.sending(sent ?? 0)
}

/** The video as the browser plays it; not there where it cannot. */
function LocalVideo({ file }: { readonly file: File }) {
  const [plays, setPlays] = useState(true)
  const url = useMemo(() => URL.createObjectURL(file), [file])
  useEffect(() => () => URL.revokeObjectURL(url), [url])
  if (!plays) return null
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches
  return (
    <video
      src={url}
      aria-label={words.playing}
      muted
      loop
      playsInline
      autoPlay={!still}
      controls={still}
      onError={() => setPlays(false)}
    />
  )
}
