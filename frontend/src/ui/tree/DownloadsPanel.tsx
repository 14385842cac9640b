import type { ButtonHTMLAttributes, ComponentChildren } from 'preact'
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks'
import type { Model } from '../../api/types'
import { isDrawn, isPaper, SHEET_NAMES, sheetOf } from '../../sheets'
import type { State } from '../../state'
import { frameToWire, onSheet, toWire, viewsToWire } from '../../strokes'
import { canTrace } from '../../studio/inputs'
import { fileName } from '../../studio/project'
import { sketchToWire } from '../../studio/sketches'
import type { Studio } from '../../studio/studio'
import { treeOf, variantsOf, withVariant } from '../../studio/variants'
import { text } from '../../text'
import { copyText } from '../parts/copying'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { saveFile, saveProject } from '../parts/saving'
import { useStore, useStudio } from '../parts/useStore'
import { type Download, downloadsOf } from './downloadList'
import { Panel } from './Panel'
import './downloadsPanel.css'

/** How long the link is said to be copied. */
const COPIED_MS = 2500
const GROUP_ICONS = { tree: ICONS.tree, levels: ICONS.layers, formats: ICONS.paper, skeleton: ICONS.bones } as const

interface Props {
  /** Makes a picture of what the preview shows. */
  picture(): Promise<Blob>
  /** Opens the settings of what files there are. */
  moreFormats(): void
}

/** The panel with everything that can be downloaded. */
export function DownloadsPanel({ picture, moreFormats }: Props) {
  const studio = useStudio()
  const model = useStore(state => state.model?.info ?? null)
  const variant = useStore(state => state.model?.variant ?? 1)
  const hasTree = useStore(state => treeUrl(state) !== null)
  const isShown = useStore(state => Boolean(state.liveTree ?? state.model?.glb))
  const canSave = useStore(canTrace)
  return (
    <Panel id="downloads" title={text.files.title}>
      <div class="tree-downloads">{model && hasTree && <TreeDownloads model={model} variant={variant} />}</div>
      <SaveButton
        class="download more-formats"
        icon={ICONS.sliders}
        words={text.files.moreFormats}
        hidden={!hasTree}
        onClick={moreFormats}
      />
      <DownloadGroup title={text.files.groups.drawing}>
        <SaveButton
          icon={ICONS.photo}
          words={text.files.png}
          hidden={!isShown}
          onClick={() => void savePicture(studio, picture)}
        />
        <SaveButton
          icon={ICONS.box}
          words={text.files.project}
          hidden={!canSave}
          onClick={() => void saveProject(studio)}
        />
        <SaveButton
          icon={ICONS.stroke}
          words={text.files.strokes}
          hidden={!canSave}
          onClick={() => saveStrokes(studio)}
        />
        {model && <CopyLink key={model.id} id={model.id} />}
      </DownloadGroup>
    </Panel>
  )
}

/** The link that downloads the tree at once; nothing while there is no tree. */
export function TreeLink() {
  const model = useStore(state => state.model?.info)
  const variant = useStore(state => state.model?.variant ?? 1)
  const url = useStore(treeUrl)
  if (!model || url === null) return null
  return (
    <a
      class="button outlined tree-link"
      href={url}
      download={downloadsOf(model, variant)[0]!.saved}
      aria-label={text.files.download(text.files.glbShort)}
    >
      <Icon path={ICONS.download} />
      {text.files.glbShort}
    </a>
  )
}

/** Whether there is anything to download. */
export function hasDownloads(state: State): boolean {
  return treeUrl(state) !== null || canTrace(state)
}

/** Return where the tree is that is shown. */
function treeUrl({ model }: State): string | null {
  return (model && treeOf(model.info, model.variant)) ?? null
}

/** The files of one tree, group by group. */
function TreeDownloads({ model, variant }: { readonly model: Model; readonly variant: number }) {
  const count = variantsOf(model)
  const downloads = downloadsOf(withVariant(model, variant), variant)
  const groups = [...new Set(downloads.map(({ group }) => group))]
  return (
    <>
      {groups.map(name => (
        <DownloadGroup
          key={name}
          title={name === 'tree' && count > 1 ? text.preview.variants.oneOf(variant, count) : text.files.groups[name]}
        >
          {downloads
            .filter(({ group }) => group === name)
            .map(download => (
              <FileLink key={download.url} {...download} />
            ))}
        </DownloadGroup>
      ))}
    </>
  )
}

function DownloadGroup({ title, children }: { readonly title: string; readonly children: ComponentChildren }) {
  return (
    <section class="download-group">
      <h3>{title}</h3>
      {children}
    </section>
  )
}

function FileLink({ group, label, about, size, url, saved }: Download) {
  return (
    <a class={group === 'tree' ? 'download first' : 'download'} href={url} download={saved}>
      <Icon path={GROUP_ICONS[group]} />
      <DownloadText label={size ? text.files.sized(label, size) : label} about={about} />
    </a>
  )
}

interface SaveButtonProps extends Omit<ButtonHTMLAttributes, 'icon'> {
  readonly icon: (typeof ICONS)[keyof typeof ICONS]
  readonly words: readonly [label: string, about: string]
}

function SaveButton({ icon, words: [label, about], ...attributes }: SaveButtonProps) {
  return (
    <button type="button" class="download" {...attributes}>
      <Icon path={icon} />
      <DownloadText label={label} about={about} />
    </button>
  )
}

/** The entry that copies a link to a model, or shows it where the browser does not let it be copied. */
function CopyLink({ id }: { readonly id: string }) {
  const { store } = useStudio()
  const [isCopied, setCopied] = useState(false)
  const [refusals, setRefusals] = useState(0)
  const field = useRef<HTMLInputElement>(null)
  const link = `${location.origin}/#${id}`
  const [label, about] = text.files.link
  useEffect(() => {
    if (!isCopied) return
    const timer = setTimeout(() => setCopied(false), COPIED_MS)
    return () => clearTimeout(timer)
  }, [isCopied])
  useLayoutEffect(() => {
    if (!refusals) return
    field.current?.focus()
    field.current?.select()
  }, [refusals])
  const copy = async () => {
    if (!(await copyText(link))) return setRefusals(count => count + 1)
    setRefusals(0)
    setCopied(true)
    store.announce(text.files.copied)
  }
  return (
    <div>
      <button type="button" class="download" onClick={() => void copy()}>
        <Icon path={ICONS.link} />
        <DownloadText label={isCopied ? text.files.copied : label} about={about} />
      </button>
      <div class="link-refused" hidden={refusals === 0}>
        <p>{text.files.copyYourself}</p>
        <input class="link-field" readOnly aria-label={text.files.copyYourself} value={link} ref={field} />
      </div>
    </div>
  )
}

/** A download's name and, below it, what it is. */
function DownloadText({ label, about }: { readonly label: string; readonly about: string }) {
  return (
    <span class="download-text">
      <span class="download-label">{label}</span>
      <span class="download-about">{about}</span>
    </span>
  )
}

async function savePicture({ store }: Studio, picture: () => Promise<Blob>): Promise<void> {
  try {
    saveFile(await picture(), fileName(store.state.name, '.png'))
    store.fault('preview', null)
  } catch {
    store.fault('preview', { text: text.files.noPicture })
  }
}

function saveStrokes({ store }: Studio): void {
  const { sheets, name } = store.state
  const save = (what: string, value: unknown) =>
    saveFile(new Blob([JSON.stringify(value)], { type: 'application/json' }), fileName(name, `.${what}.json`))
  if (sheets?.source === 'capture') save('views', viewsToWire(store.strokes))
  if (sheets?.source === 'clip') save('strokes', frameToWire(store.strokes))
  if (sheets?.source === 'photo') save('strokes', toWire(onSheet(store.strokes, 'front')))
  for (const sheetName of SHEET_NAMES) {
    const sheet = sheetOf(store.state, sheetName)
    if (sheet && isPaper(store.state, sheetName) && isDrawn(store.strokes, sheetName))
      save(sheetName, sketchToWire(store.strokes, sheetName, sheet))
  }
}
