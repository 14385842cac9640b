import { isEmpty } from '../../strokes'
import type { Studio } from '../../studio/studio'

const MODEL = /^#(mdl_[0-9a-f]{24})$/
const DRAFT = 'draft'

/** Whether the address or the tab names something to open again. */
export function hasSession(): boolean {
  return modelInAddress() !== null || remembered() !== null
}

/** Open again what was open: the model that the address names, or the drawing that this tab was at. */
export async function resume(studio: Studio): Promise<void> {
  const model = modelInAddress()
  const draft = model ? await draftOf(studio, model) : await keptDraft(studio)
  if (draft) await studio.opener.openDraft(draft)
  else if (model) await studio.opener.openModel(model)
}

/** Keep the address and the tab's storage at what is open, and follow an address that is changed by hand. */
export function followSession(studio: Studio): void {
  const { store, drafts } = studio
  store.watch(
    state => state.model?.info.id ?? null,
    id => writeAddress(id),
  )
  store.watch(
    state => state.sheets?.front,
    front => remember(front ? drafts.id : null),
  )
  addEventListener('hashchange', async () => {
    if (!modelInAddress()) return
    await resume(studio)
    writeAddress(store.state.model?.info.id ?? null) // it may have named a tree that is not there
  })
  addEventListener('beforeunload', event => {
    if (!store.state.kept && store.state.sheets && !isEmpty(store.strokes)) event.preventDefault()
  })
}

function writeAddress(model: string | null): void {
  history.replaceState(null, '', model ? `#${model}` : location.pathname + location.search)
}

/** Return the id of the model that the address names. */
export function modelInAddress(): string | null {
  return MODEL.exec(location.hash)?.[1] ?? null
}

/** Find the drawing whose model it is: its strokes may be newer. This tab's own comes first, then the latest. */
async function draftOf({ drafts }: Studio, model: string): Promise<string | null> {
  const kept = await drafts.list().catch(() => [])
  const ids = kept.filter(draft => draft.model === model).map(draft => draft.id)
  return ids.find(id => id === remembered()) ?? ids[0] ?? null
}

async function keptDraft({ drafts }: Studio): Promise<string | null> {
  const id = remembered()
  return id && (await drafts.find(id).catch(() => null)) ? id : null
}

function remembered(): string | null {
  try {
    return sessionStorage.getItem(DRAFT)
  } catch {
    return null // the browser stores nothing
  }
}

function remember(id: string | null): void {
  try {
    if (id) sessionStorage.setItem(DRAFT, id)
    else sessionStorage.removeItem(DRAFT)
  } catch {
    // the browser stores nothing: a reload starts with nothing open
  }
}
