/** How far the pointer may move within a click, CSS px, and how long a click may last, ms. */
const STILL_PX = 5
const LONGEST = 500

/** Call `clicked` with the place of each click or tap, CSS px in the element; one that drags is none. */
export function listenToClicks(element: HTMLElement, clicked: (place: readonly [number, number]) => void): void {
  let down: PointerEvent | null = null
  element.addEventListener('pointerdown', event => {
    down = event.isPrimary && event.button === 0 ? event : null
  })
  element.addEventListener('pointerup', event => {
    const from = down
    down = null
    if (!from || from.pointerId !== event.pointerId || event.timeStamp - from.timeStamp > LONGEST) return
    if (Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > STILL_PX) return
    const { left, top } = element.getBoundingClientRect()
    clicked([event.clientX - left, event.clientY - top])
  })
}
