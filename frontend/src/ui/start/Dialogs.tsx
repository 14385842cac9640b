import { isAccountTab } from '../../access'
import { text } from '../../text'
import { ShortcutsDialog } from '../drawing/ShortcutsDialog'
import { useStore } from '../parts/useStore'
import { GroveDialog } from '../siblings/GroveDialog'
import { AdviceDialog } from './AdviceDialog'
import { ClipDialog } from './ClipDialog'
import { Dialog } from './Dialog'
import { FilmingDialog } from './FilmingDialog'
import { GalleryDialog } from './GalleryDialog'
import { PhotosDialog } from './PhotosDialog'

const SHOWN = {
  gallery: GalleryDialog,
  photos: PhotosDialog,
  advice: AdviceDialog,
  clip: ClipDialog,
  filming: FilmingDialog,
  grove: GroveDialog,
  shortcuts: Shortcuts,
} as const

/** The open dialog, but that about the account. */
export function Dialogs() {
  const dialog = useStore(({ dialog: open }) => (isAccountTab(open) ? null : open))
  if (!dialog) return null
  const Shown = SHOWN[dialog]
  return <Shown />
}

function Shortcuts() {
  return (
    <Dialog title={text.shortcuts.title}>
      <ShortcutsDialog />
    </Dialog>
  )
}
