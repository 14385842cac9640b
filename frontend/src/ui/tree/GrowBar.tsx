import type { ButtonHTMLAttributes, ComponentChildren, RefObject } from 'preact'
import { useLayoutEffect, useRef } from 'preact/hooks'
import { lookingOnly } from '../../access'
import type { State } from '../../state'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import { SiblingsPanel } from '../siblings/SiblingsPanel'
import { DownloadsPanel, hasDownloads, TreeLink } from './DownloadsPanel'
import { AnotherButton, GrowButton } from './growButtons'
import { canGrow, growthStatusOf, isBusy } from './growthStatus'
import { detailsOf, sentenceOf } from './growthText'
import { openerAttributes } from './Panel'
import { ScorePanel } from './ScorePanel'
import { SettingsPanel, type SettingsView } from './SettingsPanel'
import { SharePanel, sharedId } from './SharePanel'
import './growBar.css'

/** The id of the words that say where growing stands. */
const STATUS = 'growth-status'

interface Props {
  readonly settings: SettingsView
  /** Makes a picture of what the preview shows. */
  picture(): Promise<Blob>
}

/** The bar below the preview: where growing stands, Grow with its settings, and the downloads. */
export function GrowBar({ settings, picture }: Props) {
  const canDownload = useStore(hasDownloads)
  const hasTree = useStore(({ model }) => model?.info.status === 'succeeded')
  const canShare = useStore(state => sharedId(state) !== null)
  const grows = useStore(({ session }) => lookingOnly(session) === null)
  const grow = useRef<HTMLButtonElement>(null)
  return (
    <div class="growbar">
      <ProgressBar />
      <StatusLine grow={grow} />
      <div class="grow-actions">
        {grows && <GrowButton describedBy={STATUS} buttonRef={grow} />}
        {grows && <AnotherButton />}
        <Opener panel="siblings" label={text.siblings.title} hidden={!hasTree || !grows}>
          <Icon path={ICONS.trees} />
        </Opener>
        <Opener panel="share" label={text.sharing.title} hidden={!canShare}>
          <Icon path={ICONS.link} />
        </Opener>
        <Opener panel="settings" label={text.grow.settings} hidden={!grows}>
          <Icon path={ICONS.sliders} />
        </Opener>
        <TreeLink />
        <Opener panel="downloads" label={text.files.more} hidden={!canDownload}>
          <Icon path={ICONS.download} />
          <Icon path={ICONS.down} />
        </Opener>
      </div>
      <SettingsPanel {...settings} />
      <ScorePanel />
      <SiblingsPanel />
      <SharePanel />
      <DownloadsPanel picture={picture} moreFormats={() => settings.open('file')} />
    </div>
  )
}

interface OpenerProps {
  readonly panel: 'settings' | 'downloads' | 'siblings' | 'share'
  readonly label: string
  readonly hidden?: boolean
  readonly children: ComponentChildren
}

function Opener({ panel, label, hidden = false, children }: OpenerProps) {
  return (
    <button
      type="button"
      class={`button outlined ${panel}-opener`}
      title={label}
      hidden={hidden}
      {...openerAttributes(panel)}
    >
      {children}
      <span class="opener-words">{label}</span>
    </button>
  )
}

/** The bar that shows how far a tree is; it takes no room of its own. */
function ProgressBar() {
  const status = useStore(growthStatusOf)
  const percent = useStore(percentOf)
  const isKnown = status === 'growing' || status === 'loading'
  return (
    <div
      class={isKnown ? 'progress' : 'progress unknown'}
      role="progressbar"
      aria-label={text.progress.label}
      aria-valuenow={isKnown ? percent : undefined}
      hidden={!isBusy(status) && status !== 'loading'}
    >
      <div class="progress-done" style={{ '--done': String(percent / 100) }} />
    </div>
  )
}

function percentOf(state: State): number {
  return growthStatusOf(state) === 'loading' ? 100 : Math.floor((state.model?.info.progress ?? 0) * 100)
}

/** The line that says where growing stands, what is wrong, and what can be done about it. */
function StatusLine({ grow }: { readonly grow: RefObject<HTMLButtonElement | null> }) {
  const { grower } = useStudio()
  const grows = useStore(({ session }) => lookingOnly(session) === null)
  const status = useStore(growthStatusOf)
  const sentence = useStore(sentenceOf)
  const details = useStore(detailsOf)
  const isFault = useStore(({ faults, sheets }) => Boolean(faults.grow && sheets))
  const isGrown = useStore(({ model }) => model?.info.status === 'succeeded')
  return (
    <div class="growth-status">
      <div class="status-text">
        <p class={isFault ? 'status-words fault' : 'status-words'} id={STATUS}>
          {sentence}
        </p>
        <span class="status-details">{details}</span>
      </div>
      <LineButton
        shown={grows && (status === 'queued' || status === 'growing')}
        next={grow}
        onClick={() => void grower.cancel()}
      >
        {text.grow.cancel}
      </LineButton>
      <LineButton shown={isFault && canGrow(status)} next={grow} onClick={() => void grower.grow()}>
        {text.grow.tryAgain}
      </LineButton>
      <LineButton shown={isGrown && !isBusy(status) && !isFault} next={grow} {...openerAttributes('score')}>
        {text.score.details}
      </LineButton>
    </div>
  )
}

interface LineButtonProps extends ButtonHTMLAttributes {
  readonly shown: boolean
  /** What gets the focus when the button is hidden under it. */
  readonly next: RefObject<HTMLButtonElement | null>
}

function LineButton({ shown, next, ...attributes }: LineButtonProps) {
  const own = useRef<HTMLButtonElement>(null)
  // Found while it is still shown: a button that is hidden has lost the focus at once.
  const hasFocus = own.current !== null && own.current === document.activeElement
  useLayoutEffect(() => {
    if (!shown && hasFocus) next.current?.focus()
  }, [shown])
  return <button type="button" class="button outlined" ref={own} hidden={!shown} {...attributes} />
}
