import type { ButtonHTMLAttributes, ComponentChildren, RefObject } from 'preact'
import { useId, useRef } from 'preact/hooks'
import './popover.css'

const GAP_PX = 6

interface Props {
  /** The attributes of the button that opens and closes it. */
  readonly opener: ButtonHTMLAttributes
  readonly class?: string
  readonly label: string
  /** Where it is closed by more than Escape and a click elsewhere. */
  readonly panelRef?: RefObject<HTMLDivElement | null>
  readonly children: ComponentChildren
}

/** A button, and what it opens below or above itself; Escape and a click elsewhere close it. */
export function Popover({ opener, class: name = '', label, panelRef, children }: Props) {
  const id = useId()
  const button = useRef<HTMLButtonElement>(null)
  const place = (event: ToggleEvent) => {
    if (event.newState === 'open') placeBeside(event.currentTarget as HTMLElement, button.current!)
  }
  return (
    <>
      <button type="button" {...opener} popovertarget={id} ref={button} />
      <div
        id={id}
        class={`popover ${name}`.trim()}
        popover="auto"
        role="group"
        aria-label={label}
        ref={panelRef ?? null}
        onToggle={place}
      >
        {children}
      </div>
    </>
  )
}

function placeBeside(panel: HTMLElement, opener: HTMLElement): void {
  const { left, right, top, bottom } = opener.getBoundingClientRect()
  const { clientWidth, clientHeight } = document.documentElement
  const { width, height } = panel.getBoundingClientRect()
  const start = (left + right) / 2 > clientWidth / 2 ? right - width : left
  const below = bottom + GAP_PX + height <= clientHeight || top < clientHeight / 2
  panel.style.left = `${Math.max(GAP_PX, Math.min(start, clientWidth - width - GAP_PX))}px`
  panel.style.top = `${below ? bottom + GAP_PX : Math.max(GAP_PX, top - height - GAP_PX)}px`
}
