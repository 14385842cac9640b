import { useEffect, useState } from 'preact/hooks'
import type { Notice } from '../../state'
import { text } from '../../text'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import './notices.css'

const SHOWN_MS = 9000

/** The messages that have no place of their own. */
export function Notices() {
  const notices = useStore(state => state.notices)
  return (
    <div class="notices" role="status">
      {notices.map(notice => (
        <NoticeBox key={notice} notice={notice} />
      ))}
    </div>
  )
}

/** One message; it goes by itself, but not while it is pointed at or has the focus. */
function NoticeBox({ notice }: { readonly notice: Notice }) {
  const { store } = useStudio()
  const [held, setHeld] = useState(false)
  const close = () => store.dismiss(notice)
  const act = () => {
    close()
    notice.action?.run()
  }
  useEffect(() => {
    if (held || notice.stays) return
    const timer = setTimeout(() => store.dismiss(notice), SHOWN_MS)
    return () => clearTimeout(timer)
  }, [store, notice, held])
  const [hold, release] = [() => setHeld(true), () => setHeld(false)]
  return (
    <div class="notice" onPointerEnter={hold} onFocusIn={hold} onPointerLeave={release} onFocusOut={release}>
      <p>{notice.text}</p>
      {notice.action && (
        <button type="button" class="button notice-action" onClick={act}>
          {notice.action.label}
        </button>
      )}
      <IconButton label={text.notices.close} icon={ICONS.cross} onClick={close} />
    </div>
  )
}
