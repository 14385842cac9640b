import type { ButtonHTMLAttributes } from 'preact'
import { Icon } from './Icon'
import type { ICONS } from './icons'

type Props = Omit<ButtonHTMLAttributes, 'icon'> & {
  readonly label: string
  readonly icon: (typeof ICONS)[keyof typeof ICONS]
}

/** A square button with an icon, named by its label. */
export function IconButton({ label, icon, class: name = '', ...attributes }: Props) {
  return (
    <button type="button" class={`button square ${name}`.trim()} aria-label={label} title={label} {...attributes}>
      <Icon path={icon} />
    </button>
  )
}
