/** Show an element or hide it; where it is hidden under the focus, `next` has the focus from then on. */
export function setShown(element: HTMLElement, shown: boolean, next: HTMLElement): void {
  const held = element === document.activeElement
  element.hidden = !shown
  if (held && !shown) next.focus()
}
