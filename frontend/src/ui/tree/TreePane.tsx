import type { RefObject } from 'preact'
import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import { Preview } from '../../preview/preview'
import { NOTHING_SHOWN, type PreviewStatus } from '../../preview/status'
import type { State } from '../../state'
import { text } from '../../text'
import { CoverageRing } from '../capture/CoverageRing'
import { EditTools } from '../capture/EditTools'
import { followMeasured } from '../capture/followMeasured'
import { Transport } from '../film/Transport'
import type { Filmed } from '../film/useFilm'
import { Sapling } from '../parts/Sapling'
import { useStore, useStudio } from '../parts/useStore'
import { AnimationSwitch } from './AnimationSwitch'
import { announceGrowth } from './announceGrowth'
import { GrowBar } from './GrowBar'
import { PreviewButtons, ShowsSwitch, VariantChoice } from './PreviewButtons'
import { followState } from './previewContent'
import { useSettingsView } from './SettingsPanel'
import { TakenChip } from './TakenChip'
import './treePane.css'

/** The service's code for a depth that was guessed. */
const ASSUMED = 'side_assumed'

/** The tree's side of the page: the preview with its buttons, and the bar that has it grown. */
export function TreePane({ filmed }: { readonly filmed: Filmed }) {
  const { client, store, playhead } = useStudio()
  const scene = useRef<HTMLDivElement>(null)
  const { preview, status } = usePreview(scene, filmed)
  const settings = useSettingsView()
  const picture = async () => {
    const url = store.state.model?.info.files['preview.png']
    return status.webgl === 'absent' && url ? client.getFile(url) : preview().png()
  }
  return (
    <div class="previewpane">
      <div class="stage">
        <div class="scene" ref={scene} />
        <StageMessage status={status} />
        <PreviewButtons status={status} preview={preview} />
        <CoverageRing />
        <EditTools />
        <div class="stage-foot">
          <TakenChip />
          <AssumedNote />
          <ShowsSwitch webgl={status.webgl} />
          <VariantChoice />
          <AnimationSwitch status={status} preview={preview} toSettings={() => settings.open('file')} />
        </div>
      </div>
      {status.animation !== null && (
        <Transport playhead={playhead} gain={{ now: status.gain, set: gain => preview().setGain(gain) }} />
      )}
      <GrowBar settings={settings} picture={picture} />
    </div>
  )
}

/** Show the tree in an element as long as it is there; return the preview and what it shows. */
function usePreview(scene: RefObject<HTMLDivElement | null>, { parts, film }: Filmed) {
  const studio = useStudio()
  const { store, edits, captures, playhead } = studio
  const preview = useRef<Preview>(null)
  const [status, setStatus] = useState(NOTHING_SHOWN)
  useLayoutEffect(() => {
    const made = new Preview(scene.current!, {
      labels: { wipe: text.preview.wipe, canvas: text.preview.canvas },
      reducedMotion: () => matchMedia('(prefers-reduced-motion: reduce)').matches,
      playhead,
      onStatus: setStatus,
      onPhoto: photo => captures.choose(photo),
      edits: {
        picked: joint => edits.picked(joint),
        moved: (joint, to) => edits.moved(joint, to),
        drew: (joint, points) => edits.drew(joint, points),
      },
    })
    preview.current = made
    const ends = [followState(store, made), followMeasured(studio, made), announceGrowth(store)]
    return () => {
      for (const end of ends) end()
      made.end()
    }
  }, [store, scene])
  useLayoutEffect(() => {
    if (!film || !parts) return
    const canvas = document.createElement('canvas')
    const end = parts.showFilm(canvas, film)
    preview.current!.showFilm(canvas)
    return () => {
      end()
      preview.current?.showFilm(null)
    }
  }, [film, parts])
  return { preview: () => preview.current!, status }
}

/** What stands in the preview's place, or over it: an invitation, a picture where there is no 3D, what is wrong. */
function StageMessage({ status: { webgl, shows } }: { readonly status: PreviewStatus }) {
  const url = useStore(({ model }) => (model?.glb ? model.info.files['preview.png'] : undefined))
  const fault = useStore(state => state.faults.preview?.text)
  const invitation = useStore(invitationOf)
  const isAbsent = webgl === 'absent'
  const hasPicture = isAbsent && url !== undefined
  const notice = fault ?? webglNotice(webgl)
  return (
    <div class="stage-message">
      <div class="invitation" hidden={isAbsent ? hasPicture : shows !== 'empty'}>
        <Sapling />
        <p>{invitation}</p>
      </div>
      <img class="tree-picture" alt={text.preview.picture} src={hasPicture ? url : undefined} hidden={!hasPicture} />
      <p class={fault ? 'stage-notice fault' : 'stage-notice'} hidden={notice === ''}>
        {notice}
      </p>
    </div>
  )
}

/** Say what brings a tree, or that it is on its way. */
function invitationOf({ sheets, tracing }: State): string {
  if (sheets?.source === 'clip') return text.clip.empty
  return sheets?.source === 'capture' && tracing ? text.preview.reading : text.preview.empty
}

function webglNotice(webgl: PreviewStatus['webgl']): string {
  if (webgl === 'absent') return text.preview.absent
  return webgl === 'lost' ? text.preview.lost : ''
}

/** The note of what was assumed where only one side was drawn. */
function AssumedNote() {
  const isShown = useStore(isAssumed)
  return (
    <p class="overlay assumed" role="status" hidden={!isShown}>
      {isShown ? text.preview.assumed : ''}
    </p>
  )
}

function isAssumed({ sheets, traced, liveTree }: State): boolean {
  const warnings = traced?.answer.warnings ?? []
  return sheets?.source === 'sketch' && liveTree !== null && warnings.some(({ code }) => code === ASSUMED)
}
