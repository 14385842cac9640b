import type { Model } from '../../api/types'
import { fileName } from '../../studio/project'
import { treeFiles, variantsOf } from '../../studio/variants'
import { text } from '../../text'
import { bytes } from '../../text/numbers'
import { figuresOfModel } from './figures'

const GROUPS = ['tree', 'levels', 'formats', 'skeleton'] as const

/** Files that belong together. */
export type DownloadGroup = (typeof GROUPS)[number]

/** A file that can be downloaded. */
export interface Download {
  readonly group: DownloadGroup
  readonly label: string
  readonly about: string
  /** Where the service says it. */
  readonly size: string | undefined
  readonly url: string
  /** What the file is called on the disk. */
  readonly saved: string
}

/** Files that have an entry of their own, or that nobody downloads. */
const ELSEWHERE = ['preview.png', 'strokes.json', 'project', 'leaf.png']

/** List the files of one of a model's trees, the tree itself first and each group together. */
export function downloadsOf(model: Model, variant: number): Download[] {
  const files = treeFiles(model).filter(file => file.variant === variant && file.sibling === 0)
  const place = variantsOf(model) > 1 ? `.v${variant}` : ''
  const known = files.map(({ what, url }): Download => {
    const [label, about] = what === 'glb' ? text.files.glb : (text.files.known[what] ?? [what, text.files.other])
    const saved = fileName(model.name, `${place}.${what}`)
    return { group: groupOf(what), label, about, size: bytesOf(model, variant, what), url, saved }
  })
  const all = [...known, ...unknownOf(model)]
  return GROUPS.flatMap(group => all.filter(download => download.group === group))
}

/** List the files that belong to no tree by their names and that this page does not know. */
function unknownOf(model: Model): Download[] {
  const known = [...ELSEWHERE, ...treeFiles(model).map(({ name }) => name)]
  const unknown = Object.entries(model.files).filter(([name]) => !known.includes(name))
  return unknown.map(([name, url]) => ({
    ...{ group: 'formats', label: name, about: text.files.other, size: undefined, url },
    saved: fileName(model.name, `.${name}`),
  }))
}

function groupOf(what: string): DownloadGroup {
  if (what === 'glb') return 'tree'
  if (/^(lod\d+|impostor)\./.test(what)) return 'levels'
  return /^(skeleton\.|swc$)/.test(what) ? 'skeleton' : 'formats'
}

/** Return a file's size: of the tree itself by its counts, of the others where the report lists them. */
function bytesOf(model: Model, variant: number, what: string): string | undefined {
  const name = variant === 1 ? `tree.${what}` : `tree.v${variant}.${what}`
  const listed = (model.report?.files as Readonly<Record<string, unknown>> | undefined)?.[name]
  if (typeof listed === 'number') return bytes(listed)
  return what === 'glb' ? figuresOfModel(model).find(({ row }) => row === 'size')?.value : undefined
}
