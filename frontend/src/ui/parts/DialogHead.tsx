import { text } from '../../text'
import { IconButton } from './IconButton'
import { ICONS } from './icons'
import './dialogHead.css'

interface Props {
  /** Of the title, by which the dialog is named. */
  readonly id: string
  readonly title: string
  close(): void
}

/** The head of a dialog or a panel: its title and the button that closes it. */
export function DialogHead({ id, title, close }: Props) {
  return (
    <header class="dialog-head">
      <h2 id={id}>{title}</h2>
      <IconButton label={text.close} icon={ICONS.cross} onClick={close} />
    </header>
  )
}
