import type { ComponentChildren } from 'preact'
import { useEffect, useState } from 'preact/hooks'
import { type LookingOnly, lookingOnly } from '../../access'
import type { Model } from '../../api/types'
import type { Draft } from '../../studio/draftStore'
import { EXAMPLES, SKETCH_EXAMPLES } from '../../studio/examples'
import { text } from '../../text'
import { choose, chooseSketch, mayLeave, openSketch } from '../parts/files'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import { DraftCard } from './DraftCard'
import { ExampleCard, SketchCard } from './ExampleCards'
import { FilmStart } from './FilmStart'
import { Illustration } from './Illustration'
import { ManyPhotos } from './ManyPhotos'
import './welcome.css'

/** How many of the latest trees are shown. */
const TREES = 4

/** What is seen while nothing is open: what this is, and every way to start. `late`: it waits a moment for a drawing that is opened again. */
export function Welcome({ late }: { readonly late: boolean }) {
  const closed = useStore(({ sheets }) => sheets === null)
  const draws = useStore(({ session }) => lookingOnly(session) === null)
  const device = matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse'
  return (
    <div class={late ? 'welcome is-late' : 'welcome'} hidden={!closed}>
      <Hero />
      <Drafts closed={closed} />
      {draws && <Beginnings device={device} />}
      <GrownTrees closed={closed} />
    </div>
  )
}

/** What else there is to begin with. */
function Beginnings({ device }: { readonly device: 'touch' | 'mouse' }) {
  const { welcome, sheets } = text
  return (
    <>
      <Section id="examples" title={welcome.examples} hint={welcome.examplesHint[device]}>
        <ul class="picks">
          {EXAMPLES.map(example => (
            <ExampleCard key={example.name} example={example} />
          ))}
        </ul>
      </Section>
      <Section id="many" title={text.capture.welcome.title} hint={text.capture.welcome.hint}>
        <ManyPhotos />
      </Section>
      <Section id="clip" title={text.clip.welcome.title} hint={text.clip.welcome.hint}>
        <FilmStart />
      </Section>
      <Section id="sketches" title={sheets.welcome.examples} hint={sheets.welcome.examplesHint}>
        <ul class="picks pairs">
          {SKETCH_EXAMPLES.map(example => (
            <SketchCard key={example.name} example={example} />
          ))}
        </ul>
      </Section>
    </>
  )
}

function Hero() {
  const why = useStore(({ session }) => lookingOnly(session))
  const { welcome } = text
  return (
    <section class="hero">
      <div class="hero-words">
        <h1>
          {welcome.title.map(phrase => [
            <span key={phrase} class="phrase">
              {phrase}
            </span>,
            ' ',
          ])}
        </h1>
        <Lead />
        {why ? <Looking why={why} /> : <StartButtons />}
        <OpeningFault />
        {!why && <p class="soft">{welcome.formats}</p>}
      </div>
      <div class="hero-art">
        <Illustration />
      </div>
    </section>
  )
}

/** What to do, in a sentence; its two strokes are underlined in their colours. */
function Lead() {
  const { lead, leadStrokes } = text.welcome
  const parts = lead.split(/\{(leaves|trunk)\}/)
  return (
    <p class="lead">
      {parts.map(part => {
        const stroke = part === 'leaves' || part === 'trunk' ? part : null
        return stroke ? <span class={`lead-${stroke}`}>{leadStrokes[stroke]}</span> : part
      })}
    </p>
  )
}

/** The way to the trees of others, for who may look only. */
function Looking({ why }: { readonly why: LookingOnly }) {
  const { store } = useStudio()
  return (
    <>
      <p>{text.access.lookingOnly[why]}</p>
      <button type="button" class="button primary hero-choose" onClick={() => store.set({ dialog: 'gallery' })}>
        <Icon path={ICONS.gallery} />
        {text.access.toGallery}
      </button>
    </>
  )
}

/** The ways to start: with a photo, on white paper, with a drawing. */
function StartButtons() {
  const studio = useStudio()
  const { welcome, sheets } = text
  const draw = () => mayLeave(studio) && studio.opener.openPaper()
  const open = () => chooseSketch(file => openSketch(studio, file))
  return (
    <>
      <div class="hero-start">
        <button type="button" class="button primary hero-choose" onClick={() => choose(studio)}>
          <Icon path={ICONS.photo} />
          {welcome.choose}
        </button>
        <span class="hero-other">{welcome.otherWays}</span>
      </div>
      <div class="hero-start">
        <button type="button" class="button outlined hero-draw" onClick={draw}>
          <Icon path={ICONS.sheet} />
          {sheets.welcome.draw}
        </button>
        <button type="button" class="button outlined hero-draw" onClick={open}>
          <Icon path={ICONS.drawing} />
          {sheets.openDrawing}
        </button>
        <span class="soft">{sheets.welcome.drawHint}</span>
      </div>
    </>
  )
}

/** Why the last file could not be opened. */
function OpeningFault() {
  const fault = useStore(({ faults }) => faults.photo)
  return (
    <p class="fault" role="alert" hidden={!fault}>
      {fault?.text}
    </p>
  )
}

interface SectionProps {
  readonly id: string
  readonly title: string
  readonly hint: string
  readonly hidden?: boolean
  readonly children: ComponentChildren
}

function Section({ id, title, hint, hidden = false, children }: SectionProps) {
  return (
    <section class="welcome-section" aria-labelledby={id} hidden={hidden}>
      <div class="welcome-section-head">
        <h2 id={id}>{title}</h2>
        <p class="soft">{hint}</p>
      </div>
      {children}
    </section>
  )
}

/** The drawings that are kept in this browser. */
function Drafts({ closed }: { readonly closed: boolean }) {
  const studio = useStudio()
  const [drafts, setDrafts] = useState<readonly Draft[]>([])
  const list = async () => setDrafts(await studio.drafts.list().catch(() => []))
  useEffect(() => {
    if (closed) void list()
  }, [closed])
  return (
    <Section id="drafts" title={text.welcome.drafts} hint={text.welcome.draftsHint} hidden={!drafts.length}>
      <ul class="picks small">
        {drafts.map(draft => (
          <DraftCard key={draft.id} draft={draft} changed={list} />
        ))}
      </ul>
    </Section>
  )
}

/** The way to the gallery, with its latest trees; hidden before the first tree. */
function GrownTrees({ closed }: { readonly closed: boolean }) {
  const { store, client } = useStudio()
  const isShared = useStore(({ session }) => session !== null)
  const [models, setModels] = useState<readonly Model[]>([])
  useEffect(() => {
    if (!closed) return
    const list = async () => setModels((await client.listModels(null).catch(() => null))?.models ?? [])
    void list()
  }, [closed])
  const pictures = models.flatMap(({ files }) => files['preview.png'] ?? []).slice(0, TREES)
  return (
    <div class="welcome-section" hidden={!models.length}>
      <button type="button" class="button outlined grown" onClick={() => store.set({ dialog: 'gallery' })}>
        <Icon path={ICONS.gallery} />
        {isShared ? text.welcome.grownByTeam : text.welcome.grown}
        <span class="grown-pictures">
          {pictures.map(url => (
            <img key={url} src={url} alt="" />
          ))}
        </span>
      </button>
    </div>
  )
}
