/** How far the pointer may move within a click, CSS px, and how long a click may last, ms. */
const STILL_PX = 5
const LONGEST = 500

/** Call `clicked` with the place of each click or tap, CSS px in the element; one that drags is none. The signal ends it. */
export function listenToClicks(
  element: HTMLElement,
  signal: AbortSignal,
  clicked: (place: readonly [number, number]) => void,
): void {
  let down: PointerEvent | null = null
  const press = (event: PointerEvent) => {
    down = event.isPrimary && event.button === 0 ? event : null
  }
  const release = (event: PointerEvent) => {
    const from = down
    down = null
    if (!from || from.pointerId !== event.pointerId || event.timeStamp - from.timeStamp > LONGEST) return
    if (Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > STILL_PX) return
    const { left, top } = element.getBoundingClientRect()
    clicked([event.clientX - left, event.clientY - top])
  }
  element.addEventListener('pointerdown', press, { signal })
  element.addEventListener('pointerup', release, { signal })
}
