import type { ButtonHTMLAttributes, ComponentChildren, RefObject } from 'preact'
import { useLayoutEffect, useRef, useState } from 'preact/hooks'
import { DialogHead } from '../parts/DialogHead'

interface Props {
  readonly id: string
  readonly title: string
  /** Where it is opened by more than its button. */
  readonly panelRef?: RefObject<HTMLDivElement | null>
  readonly children: ComponentChildren
  closed?(): void
}

/** A panel that opens over the stage, on a phone from below; Escape and a click beside it close it. */
export function Panel({ id, title, panelRef, closed, children }: Props) {
  const own = useRef<HTMLDivElement>(null)
  const panel = panelRef ?? own
  const [isOpen, setOpen] = useState(false)
  useLayoutEffect(() => {
    if (!isOpen) return
    const place = () => placeOver(panel.current!)
    addEventListener('resize', place)
    return () => removeEventListener('resize', place)
  }, [isOpen, panel])
  const opens = ({ newState }: ToggleEvent) => newState === 'open' && placeOver(panel.current!)
  const toggled = ({ newState }: ToggleEvent) => {
    setOpen(newState === 'open')
    if (newState === 'closed') closed?.()
  }
  const heading = `${id}-title`
  return (
    <div
      class="panel"
      id={id}
      popover="auto"
      role="dialog"
      aria-labelledby={heading}
      ref={panel}
      onBeforeToggle={opens}
      onToggle={toggled}
    >
      <DialogHead id={heading} title={title} close={() => panel.current?.hidePopover()} />
      {children}
    </div>
  )
}

/** Return the attributes of a button that opens and closes the panel with this id. */
export function openerAttributes(id: string): ButtonHTMLAttributes {
  return { popovertarget: id, 'aria-haspopup': 'dialog' }
}

/** Lay a panel above the bar that opens it; the stylesheet decides otherwise where there is no room. */
function placeOver(panel: HTMLElement): void {
  const bar = panel.closest('.growbar')?.getBoundingClientRect()
  const pane = panel.closest('.previewpane')?.getBoundingClientRect()
  if (!bar || !pane) return
  panel.style.setProperty('--left', `${bar.left}px`)
  panel.style.setProperty('--width', `${bar.width}px`)
  panel.style.setProperty('--above', `${window.innerHeight - bar.top}px`)
  panel.style.setProperty('--room', `${bar.top - pane.top}px`)
}
