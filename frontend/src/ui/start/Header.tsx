import type { TargetedKeyboardEvent, TargetedMouseEvent } from 'preact'
import { lookingOnly } from '../../access'
import { text } from '../../text'
import { Account } from '../account/Account'
import { choose, mayLeave } from '../parts/files'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { Popover } from '../parts/Popover'
import { saveProject } from '../parts/saving'
import { withCtrl } from '../parts/shortcutKeys'
import { useStore, useStudio } from '../parts/useStore'
import './header.css'

/** The page's head: home, the drawing's name, and what can be done with the drawing as a whole. */
export function Header() {
  const closed = useStore(({ sheets }) => sheets === null)
  const opener = {
    class: 'button square head-more',
    'aria-label': text.header.menu,
    children: <Icon path={ICONS.more} />,
  }
  return (
    <header class={closed ? 'head is-closed' : 'head'}>
      <div class="head-row">
        <Wordmark />
        <NameField />
        <Popover opener={opener} class="head-menu" label={text.header.menu}>
          <Actions />
        </Popover>
        <Account />
      </div>
    </header>
  )
}

function Wordmark() {
  const studio = useStudio()
  const leave = () => mayLeave(studio) && studio.opener.close()
  return (
    <button type="button" class="button wordmark" title={text.header.home} onClick={leave}>
      <Mark />
      <span>{text.app}</span>
    </button>
  )
}

/** The two strokes: the crown's and the trunk's. */
function Mark() {
  const crown = 'M13.5 3.8C8 4.5 4.5 8.3 4.5 12.9c0 5 4.7 8.6 11.5 8.6s11.5-3.6 11.5-8.6c0-5.2-4.6-9.2-10.5-9.4'
  return (
    <svg viewBox="0 0 32 32" class="mark" aria-hidden="true">
      <path class="mark-crown" d={crown} />
      <path class="mark-trunk" d="M16 29V11.5M16 20l4.8-4.8M16 17l-4-4" />
    </svg>
  )
}

function NameField() {
  const { store } = useStudio()
  const name = useStore(state => state.name)
  const longest = useStore(state => state.limits?.name_length)
  const leave = ({ key, currentTarget: field }: TargetedKeyboardEvent<HTMLInputElement>) => {
    if (key === 'Escape') field.value = name
    if (key === 'Enter' || key === 'Escape') field.blur()
  }
  return (
    <div class="head-title">
      <h1 class="visually-hidden">{name || text.header.untitled}</h1>
      <input
        class="head-name"
        aria-label={text.header.name}
        placeholder={text.header.untitled}
        value={name}
        maxLength={longest}
        spellcheck={false}
        onChange={event => store.set({ name: event.currentTarget.value.trim() })}
        onKeyDown={leave}
      />
    </div>
  )
}

function Actions() {
  const studio = useStudio()
  const { header } = text
  const draws = useStore(({ session }) => lookingOnly(session) === null)
  const show = (dialog: 'gallery' | 'shortcuts') => studio.store.set({ dialog })
  return (
    <>
      {draws && <Action label={header.newPhoto} icon="photo" act={() => choose(studio, 'photo')} ofDrawing />}
      <Action label={header.open} icon="open" shortcut={withCtrl('O')} act={() => choose(studio)} ofDrawing />
      <Action label={header.save} icon="save" shortcut={withCtrl('S')} act={() => saveProject(studio)} ofDrawing />
      <Action label={header.gallery} icon="gallery" act={() => show('gallery')} />
      <Action label={header.shortcuts} icon="keys" shortcut="?" act={() => show('shortcuts')} />
    </>
  )
}

interface ActionProps {
  readonly label: string
  readonly icon: keyof typeof ICONS
  readonly shortcut?: string
  /** It is there only while a drawing is open. */
  readonly ofDrawing?: true
  act(): unknown
}

function Action({ label, icon, shortcut, ofDrawing, act }: ActionProps) {
  const run = ({ currentTarget }: TargetedMouseEvent<HTMLButtonElement>) => {
    currentTarget.closest<HTMLElement>(':popover-open')?.hidePopover()
    act()
  }
  return (
    <button
      type="button"
      class={ofDrawing ? 'button of-drawing' : 'button'}
      title={shortcut ? text.tools.withKey(label, shortcut) : label}
      onClick={run}
    >
      <Icon path={ICONS[icon]} />
      {label}
    </button>
  )
}
