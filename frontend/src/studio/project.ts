import { strFromU8, strToU8, unzipSync, zipSync } from 'fflate'
import { DEFAULT_SETTINGS, type Settings } from '../state'
import { fromWire, type Strokes, toWire } from '../strokes'
import { text } from '../text'
import { Unusable } from './sentences'

/** What a project file holds. */
export interface Project {
  readonly photo: Blob
  readonly strokes: Strokes
  readonly settings: Settings
  readonly seed: number
  /** The person's own picture of a leaf. */
  readonly leaf: Blob | null
}

const ENDING = '.treestroke'
const LEAF = 'leaf.png'
const TYPES: Readonly<Record<string, string>> = { jpg: 'image/jpeg', png: 'image/png', webp: 'image/webp' }

export function isProject(file: File): boolean {
  return file.name.endsWith(ENDING) || file.type === 'application/zip'
}

/** Name a project's file. */
export function projectName(name: string): string {
  return fileName(name, ENDING)
}

/** Name a file after a drawing; `ending` begins with its dot. */
export function fileName(name: string, ending: string): string {
  return `${name.replace(/[\\/:*?"<>|]/g, '_') || 'tree'}${ending}`
}

/** Write a project as the command line and the service do: a ZIP of the pictures, strokes.json and settings.json. */
export async function writeProject({ photo, strokes, settings, seed, leaf }: Project): Promise<Blob> {
  const ending = Object.keys(TYPES).find(key => TYPES[key] === photo.type) ?? 'jpg'
  const archive = zipSync({
    [`photo.${ending}`]: [new Uint8Array(await photo.arrayBuffer()), { level: 0 }],
    ...(leaf && { [LEAF]: [new Uint8Array(await leaf.arrayBuffer()), { level: 0 }] }),
    'strokes.json': strToU8(JSON.stringify(toWire(strokes))),
    'settings.json': strToU8(JSON.stringify({ ...settings, seed }, null, 2)),
  })
  return new Blob([archive], { type: 'application/zip' })
}

/** Read a project, or throw `Unusable` where it is damaged or none. */
export async function readProject(file: Blob): Promise<Project> {
  const members = await unzip(file)
  const photo = Object.keys(members).find(name => /^photo\.\w+$/.test(name))
  const strokes = members['strokes.json']
  if (!photo || !strokes) throw new Unusable(text.faults.projectIncomplete)
  const { seed, ...settings } = settingsOf(members['settings.json'])
  return {
    photo: new Blob([new Uint8Array(members[photo]!)], { type: TYPES[photo.split('.')[1]!] ?? '' }),
    strokes: strokesOf(strokes),
    settings: { ...DEFAULT_SETTINGS, ...settings },
    seed: seed ?? 0,
    leaf: members[LEAF] ? new Blob([new Uint8Array(members[LEAF])], { type: 'image/png' }) : null,
  }
}

async function unzip(file: Blob): Promise<Record<string, Uint8Array>> {
  const bytes = new Uint8Array(await file.arrayBuffer())
  try {
    return unzipSync(bytes)
  } catch {
    throw new Unusable(text.faults.projectUnreadable)
  }
}

function strokesOf(json: Uint8Array): Strokes {
  try {
    return fromWire(JSON.parse(strFromU8(json)))
  } catch {
    throw new Unusable(text.faults.projectUnreadable)
  }
}

/** Read settings; values are for the service to judge, which says what is allowed. */
function settingsOf(json: Uint8Array | undefined): Partial<Settings> & { seed?: number } {
  try {
    return json ? JSON.parse(strFromU8(json)) : {}
  } catch {
    throw new Unusable(text.faults.projectUnreadable)
  }
}
