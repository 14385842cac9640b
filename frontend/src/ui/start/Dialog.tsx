import type { ComponentChildren } from 'preact'
import { useId, useLayoutEffect, useRef } from 'preact/hooks'
import type { State } from '../../state'
import { DialogHead } from '../parts/DialogHead'
import { useStudio } from '../parts/useStore'
import { Notices } from './Notices'
import './dialog.css'

const CLOSED: Partial<State> = { dialog: null }

interface Props {
  readonly title: string
  readonly class?: string
  /** How the state changes when it is closed. */
  readonly after?: Partial<State>
  readonly children: ComponentChildren
}

/** A modal dialog; Escape, its cross and a click beside it close it, and focus goes back to where it was. */
export function Dialog({ title, class: name = '', after = CLOSED, children }: Props) {
  const { store } = useStudio()
  const id = useId()
  const dialog = useRef<HTMLDialogElement>(null)
  const replaced = useRef(false)
  const close = () => dialog.current?.close()
  useLayoutEffect(() => {
    const shown = dialog.current!
    shown.showModal()
    return () => {
      replaced.current = true
      shown.close() // which gives the focus back
    }
  }, [])
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: Escape closes a dialog by itself
    <dialog
      ref={dialog}
      class={`dialog ${name}`.trim()}
      aria-labelledby={id}
      onClick={event => event.target === event.currentTarget && close()}
      // The browser tells it later, when another dialog may be open.
      onClose={() => !replaced.current && store.set(after)}
    >
      <DialogHead id={id} title={title} close={close} />
      {children}
      <Notices />
    </dialog>
  )
}
