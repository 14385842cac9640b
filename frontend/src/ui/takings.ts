import type { Model } from '../api/types'
import { fileName } from '../studio/project'
import { treeFiles, variantsOf } from '../studio/variants'
import { text } from '../text'
import { figuresOfModel, sizeOf } from './figures'

/** Files that belong together. */
export type Shelf = 'tree' | 'levels' | 'formats' | 'skeleton'

/** A file that can be taken away. */
export interface Taking {
  readonly shelf: Shelf
  readonly label: string
  readonly about: string
  /** Where the service says it. */
  readonly size: string | undefined
  readonly url: string
  /** What the file is called on the disk. */
  readonly saved: string
}

/** What has an entry of its own, or is none to take away. */
const ELSEWHERE = ['preview.png', 'strokes.json', 'project', 'leaf.png']
const SHELVES: readonly Shelf[] = ['tree', 'levels', 'formats', 'skeleton']

/** List the files of one of a model's trees, the tree itself first and each shelf by itself. */
export function takingsOf(model: Model, variant: number): Taking[] {
  const files = treeFiles(model).filter(file => file.variant === variant)
  const place = variantsOf(model) > 1 ? `.v${variant}` : ''
  const takings = files.map(({ what, url }): Taking => {
    const [label, about] = what === 'glb' ? text.files.glb : (text.files.known[what] ?? [what, text.files.other])
    const saved = fileName(model.name, `${place}.${what}`)
    return { shelf: shelfOf(what), label, about, size: bytesOf(model, variant, what), url, saved }
  })
  const all = [...takings, ...unknownOf(model)]
  return SHELVES.flatMap(shelf => all.filter(taking => taking.shelf === shelf))
}

/** List the files that belong to no tree by their names and that this page does not know. */
function unknownOf(model: Model): Taking[] {
  const known = [...ELSEWHERE, ...treeFiles(model).map(({ name }) => name)]
  const unknown = Object.entries(model.files).filter(([name]) => !known.includes(name))
  return unknown.map(([name, url]) => ({
    ...{ shelf: 'formats', label: name, about: text.files.other, size: undefined, url },
    saved: fileName(model.name, `.${name}`),
  }))
}

function shelfOf(what: string): Shelf {
  if (what === 'glb') return 'tree'
  if (/^(lod\d+|impostor)\./.test(what)) return 'levels'
  return /^(skeleton\.|swc$)/.test(what) ? 'skeleton' : 'formats'
}

/** Give a file's size: of the tree itself by its counts, of the others where the report lists them. */
function bytesOf(model: Model, variant: number, what: string): string | undefined {
  const name = variant === 1 ? `tree.${what}` : `tree.v${variant}.${what}`
  const listed = (model.report?.files as Readonly<Record<string, unknown>> | undefined)?.[name]
  if (typeof listed === 'number') return sizeOf(listed)
  return what === 'glb' ? figuresOfModel(model).find(({ row }) => row === 'size')?.value : undefined
}
