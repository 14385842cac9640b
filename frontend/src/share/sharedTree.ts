import type { components } from '../api/schema'

export type SharedModel = components['schemas']['SharedModel']

/** Why a shared tree is not shown: its link leads nowhere, is over, or the service does not answer. */
export type Lack = 'missing' | 'over' | 'unreachable'

/** A tree that was shared, or why it is not shown. */
export type Answer = { readonly tree: SharedModel } | { readonly lack: Lack }

/** Return where the page's link lies, without what follows it. */
export function linkOf({ origin, pathname }: Pick<Location, 'origin' | 'pathname'>): string {
  return origin + pathname.replace(/\/+$/, '')
}

/** Ask what a link leads to. */
export async function askFor(link: string): Promise<Answer> {
  const response = await fetch(`${link}/model.json`).catch(() => null)
  if (response?.ok) return { tree: await response.json() }
  if (response?.status === 404) return { lack: 'missing' }
  return { lack: response?.status === 410 ? 'over' : 'unreachable' }
}

/** Load the tree's GLB; null where that fails. */
export async function loadTree(link: string): Promise<ArrayBuffer | null> {
  const response = await fetch(`${link}/tree.glb`).catch(() => null)
  return response?.ok ? response.arrayBuffer().catch(() => null) : null
}

/** Return the code that shows a tree in the frame of another page. */
export function embedCode(link: string, name: string): string {
  const quoted = name.replaceAll('&', '&amp;').replaceAll('"', '&quot;').replaceAll('<', '&lt;')
  return `<iframe src="${link}?embed" width="800" height="600" title="${quoted}"></iframe>`
}
