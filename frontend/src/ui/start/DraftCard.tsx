import { useMemo } from 'preact/hooks'
import type { Draft, DraftWithPictures } from '../../studio/draftStore'
import { text } from '../../text'
import { PairPicture } from '../parts/drawn'
import { mayLeave } from '../parts/files'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useLoaded } from '../parts/useLoaded'
import { useStudio } from '../parts/useStore'
import { ago } from './when'

interface Props {
  readonly draft: Draft
  /** Called when it was deleted or restored. */
  changed(): Promise<void>
}

/** A drawing that the browser keeps: opened by a click, deleted by its cross. */
export function DraftCard({ draft, changed }: Props) {
  const studio = useStudio()
  const { drafts, opener, store } = studio
  const name = draft.name || text.header.untitled
  const kept = useLoaded(() => drafts.find(draft.id), [draft.id, draft.saved])
  const remove = async () => {
    const found = await drafts.find(draft.id)
    await drafts.remove(draft.id)
    await changed()
    const restore = async () => {
      if (found) await drafts.restore(found)
      await changed()
    }
    const action = { label: text.welcome.undo, run: () => void restore() }
    store.notify({ text: text.welcome.draftDeleted(name), action })
  }
  return (
    <li>
      <button type="button" class="pick" onClick={() => mayLeave(studio) && opener.openDraft(draft.id)}>
        <span class={kept && !kept.photo ? 'pick-photo on-paper' : 'pick-photo'}>
          {kept && <DraftPicture {...kept} />}
        </span>
        <span class="pick-name">{name}</span>
        <span class="pick-when">{ago(draft.saved)}</span>
      </button>
      <IconButton label={text.welcome.deleteDraft(name)} icon={ICONS.remove} class="pick-remove" onClick={remove} />
    </li>
  )
}

function DraftPicture({ photo, draft }: DraftWithPictures) {
  const url = useMemo(() => photo && URL.createObjectURL(photo), [photo])
  if (!url) return <PairPicture front={draft.photo} strokes={draft.history.present} side={draft.side ?? null} />
  return <img src={url} alt="" onLoad={() => URL.revokeObjectURL(url)} />
}
