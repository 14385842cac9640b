import { useEffect, useState } from 'preact/hooks'
import { isPaper } from '../../sheets'
import type { SheetName } from '../../strokes'
import { isPicture, typeOf } from '../../studio/photos'
import type { Studio } from '../../studio/studio'
import { isVideoType } from '../../studio/videos'
import { text } from '../../text'
import { droppedIn } from '../parts/dropped'
import { openFile, openFiles, openSketch } from '../parts/files'
import { useStudio } from '../parts/useStore'
import './dropArea.css'

/** What can be done with a file that is dropped. */
interface Use {
  /** What it is, and perhaps what it is for. */
  readonly words: readonly string[]
  /** Absent: the file is opened as what it is. */
  take?(file: File): void
}

/** The part of the page that files are dragged over, and what can be done with them there, one field below the other. */
interface Target {
  readonly place: DOMRect
  readonly uses: readonly Use[]
  /** The one that the pointer is at. */
  readonly chosen: Use | undefined
}

/** Without an event for so long, ms, the files have left the page. */
const LEFT_MS = 300

/** Opens what is dropped on the page or pasted into it, and shows what will be done with it while it is dragged. */
export function DropArea() {
  const studio = useStudio()
  const [target, setTarget] = useState<Target | null>(null)
  useEffect(() => {
    const listening = new AbortController()
    const { signal } = listening
    addEventListener('dragover', event => dragged(studio, event, setTarget), { signal })
    addEventListener('drop', event => dropped(studio, event, setTarget), { signal })
    addEventListener('paste', event => pasted(studio, event), { signal })
    return () => listening.abort()
  }, [studio])
  useEffect(() => {
    const leaving = setTimeout(() => setTarget(null), LEFT_MS)
    return () => clearTimeout(leaving)
  }, [target])
  if (!target) return null
  const { left, top, width, height } = target.place
  return (
    <div class="drop-area" style={{ left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` }}>
      {target.uses.map(use => (
        <Field key={use.words[0]} words={use.words} chosen={use === target.chosen} />
      ))}
    </div>
  )
}

function Field({ words: [title, why], chosen }: Pick<Use, 'words'> & { readonly chosen: boolean }) {
  return (
    <p class={chosen ? 'drop-field chosen' : 'drop-field'}>
      <strong>{title}</strong>
      {why && <span>{why}</span>}
    </p>
  )
}

type Show = (target: Target | null) => void

function dragged(studio: Studio, event: DragEvent, show: Show): void {
  if (!event.dataTransfer?.types.includes('Files')) return
  event.preventDefault()
  const types = [...event.dataTransfer.items].map(({ type }) => type) // a folder's is empty
  show(targetOf(studio, event, types))
}

function dropped(studio: Studio, event: DragEvent, show: Show): void {
  event.preventDefault()
  show(null)
  if (!event.dataTransfer) return
  const files = [...event.dataTransfer.files]
  const picture = files.find(file => isPicture(file) || file.type === 'application/json')
  const { chosen } = targetOf(studio, event, files.map(typeOf))
  if (picture && chosen?.take) chosen.take(picture)
  else void droppedIn(event.dataTransfer).then(dropped => openFiles(studio, dropped.files, dropped.folder))
}

function pasted(studio: Studio, event: ClipboardEvent): void {
  const picture = [...(event.clipboardData?.files ?? [])].find(isPicture)
  if (picture) openFile(studio, named(picture))
}

function targetOf(studio: Studio, event: DragEvent, types: readonly string[]): Target {
  const part = event.target instanceof Element ? event.target.closest<HTMLElement>('[data-of]') : null
  const sheet = part?.dataset.of as SheetName | undefined
  const areMany = types.filter(type => type.startsWith('image/')).length > 1
  const [over, uses] =
    part && sheet && !areMany && isPaper(studio.store.state, sheet)
      ? [part, usesOnSheet(studio, sheet, types)]
      : [null, usesOnPage(studio, types)]
  const place = over?.getBoundingClientRect() ?? new DOMRect(0, 0, innerWidth, innerHeight)
  const field = Math.floor(((event.clientY - place.top) / place.height) * uses.length)
  return { place, uses, chosen: uses[Math.min(Math.max(field, 0), uses.length - 1)] }
}

/** What can be done with files dropped on the page, by their types: a PNG may be a photo or a drawing, which only the user knows. */
function usesOnPage(studio: Studio, types: readonly string[]): readonly Use[] {
  const { drop } = text.sheets
  const images = types.filter(type => type.startsWith('image/') && !isVideoType(type)).length
  if (images > 1) return [{ words: [text.capture.offer.drop] }]
  if (!images && types.some(isVideoType)) return [{ words: [text.clip.drop] }]
  const photo: Use = { words: drop.photo, take: file => openFile(studio, file) }
  const drawing: Use = { words: drop.drawing, take: file => openSketch(studio, file) }
  return usesOf(types, photo, drawing) ?? [{ words: [text.welcome.drop] }]
}

/** What can be done with files dropped on a sheet of paper. */
function usesOnSheet({ sheets, opener }: Studio, sheet: SheetName, types: readonly string[]): readonly Use[] {
  const { drop } = text.sheets
  const photo: Use = { words: drop.picture, take: file => void sheets.addPicture(sheet, file) }
  const drawing: Use = { words: drop.drawing, take: file => void opener.openOn(sheet, file) }
  const isImage = types.some(type => type.startsWith('image/'))
  return usesOf(types, photo, drawing) ?? [isImage ? photo : { words: [text.welcome.drop] }]
}

function usesOf(types: readonly string[], photo: Use, drawing: Use): readonly Use[] | null {
  if (types.includes('image/png')) return [photo, drawing]
  return types.includes('application/json') ? [drawing] : null
}

function named(picture: File): File {
  return new File([picture], `${text.welcome.pasted}.${picture.type.split('/')[1]}`, { type: picture.type })
}
