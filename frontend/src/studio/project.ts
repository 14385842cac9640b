import { strFromU8, strToU8, unzipSync, type Zippable, zipSync } from 'fflate'
import { DEFAULT_SETTINGS } from '../api/defaults'
import type { Settings } from '../api/types'
import type { Edit } from '../edits'
import { isDrawn } from '../sheets'
import {
  frameFromWire,
  frameToWire,
  fromWire,
  onSheet,
  type SheetName,
  type Strokes,
  toWire,
  viewsFromWire,
  viewsToWire,
} from '../strokes'
import { text } from '../text'
import { PageFault } from './faultText'
import { TYPES } from './photos'
import { type Drawn, pairSketches, type SketchFile, sketchFrom, sketchToWire } from './sketches'
import { VIDEO_TYPES } from './videos'

/** What a project file holds. */
export interface Project extends Drawn {
  /** Null for sketches on paper. */
  readonly photo: Blob | null
  /** Many photos of one tree, in place of one. */
  readonly photos?: readonly File[]
  /** A video of the tree, in place of a photo. */
  readonly clip?: File
  readonly settings: Settings
  readonly seed: number
  /** The own pictures of a leaf and a fruit. */
  readonly leaf: Blob | null
  readonly fruit?: Blob | null
}

const ENDING = '.treestroke'
const PICTURES = { leaf: 'leaf.png', fruit: 'fruit.png' } as const
const SHEETS = ['front', 'side'] as const

/** Return whether a file is a project, by its name or type. */
export function isProject(file: File): boolean {
  return file.name.endsWith(ENDING) || file.type === 'application/zip'
}

/** Return the name of a project's file. */
export function projectName(name: string): string {
  return fileName(name, ENDING)
}

/** Return a file name for a drawing's name; `ending` begins with its dot. */
export function fileName(name: string, ending: string): string {
  return `${name.replace(/[\\/:*?"<>|]/g, '_') || 'tree'}${ending}`
}

/** Return a project file as the command line and the service write it: a ZIP of pictures, strokes and settings.json. */
export async function writeProject(project: Project): Promise<Blob> {
  const { photo, settings, seed, ...own } = project
  const ending = Object.keys(TYPES).find(key => TYPES[key] === photo?.type) ?? 'jpg'
  const archive = zipSync({
    ...(await member(`photo.${ending}`, photo)),
    ...(await member(PICTURES.leaf, own.leaf)),
    ...(await member(PICTURES.fruit, own.fruit ?? null)),
    ...(await drawnIn(project)),
    'settings.json': strToU8(JSON.stringify({ ...settings, seed }, null, 2)),
  })
  return new Blob([archive], { type: 'application/zip' })
}

/** Return a picture as an uncompressed member of the archive. */
async function member(name: string, picture: Blob | null): Promise<Record<string, [Uint8Array, { level: 0 }]>> {
  return picture ? { [name]: [new Uint8Array(await picture.arrayBuffer()), { level: 0 }] } : {}
}

/** Return what is drawn as members, with the photos or the video that it is drawn over, where these are no single photo. */
async function drawnIn({ photos, clip, strokes, sizes = {} }: Project): Promise<Zippable> {
  if (photos) return photosWithStrokes(photos, strokes)
  if (!clip) return drawings(strokes, sizes)
  const ending = /\.\w+$/.exec(clip.name)?.[0].toLowerCase() ?? '.mp4'
  return { ...(await member(`clip${ending}`, clip)), 'frame_strokes.json': jsonBytes(frameToWire(strokes)) }
}

/** Return many photos as members, with the strokes over them and the edits of what they show. */
async function photosWithStrokes(photos: readonly File[], strokes: Strokes): Promise<Zippable> {
  const members = await Promise.all(photos.map(photo => member(memberOf(photo), photo)))
  const { edits } = strokes
  return {
    ...Object.assign({}, ...members),
    'views.json': jsonBytes(viewsToWire(strokes)),
    ...(edits?.length && { 'edits.json': jsonBytes({ edits }) }),
  }
}

/** Return the name of a photo's member: the service's pictures are PNGs, whatever the photo was. */
function memberOf({ name, type }: File): string {
  return `photos/${name}${type === 'image/png' && !/\.png$/i.test(name) ? '.png' : ''}`
}

function drawings(strokes: Strokes, sizes: NonNullable<Project['sizes']>): Record<string, Uint8Array> {
  const own = { 'strokes.json': jsonBytes(toWire(onSheet(strokes, 'front'))) }
  return { ...(sizes.front ? {} : own), ...sketches(strokes, sizes) }
}

function sketches(strokes: Strokes, sizes: NonNullable<Project['sizes']>): Record<string, Uint8Array> {
  const drawn = SHEETS.flatMap(sheet => {
    const size = sizes[sheet]
    return size && isDrawn(strokes, sheet) ? [[`${sheet}.json`, jsonBytes(sketchToWire(strokes, sheet, size))]] : []
  })
  return Object.fromEntries(drawn)
}

function jsonBytes(value: unknown): Uint8Array {
  return strToU8(JSON.stringify(value))
}

/** Reads a sketch that is a picture. */
type ReadPicture = (picture: Blob) => Promise<SketchFile>

/** Return what a project file holds; throws `PageFault` where it is damaged or no project. */
export async function readProject(file: Blob, readPicture: ReadPicture): Promise<Project> {
  const members = await unzip(file)
  const photo = Object.keys(members).find(name => /^photo\.\w+$/.test(name))
  const { seed, ...settings } = settingsOf(members['settings.json'])
  return {
    photo: photo ? picture(members[photo], TYPES[photo.split('.')[1]!]) : null,
    ...(await sourceIn(members, photo !== undefined, readPicture)),
    settings: { ...DEFAULT_SETTINGS, ...settings },
    seed: seed ?? 0,
    leaf: picture(members[PICTURES.leaf]),
    fruit: picture(members[PICTURES.fruit]),
  }
}

/** Return the drawing in a project, with the photos or the video that it is drawn over, where these are no single photo. */
async function sourceIn(
  members: Record<string, Uint8Array>,
  hasPhoto: boolean,
  readPicture: ReadPicture,
): Promise<Drawn & Pick<Project, 'photos' | 'clip'>> {
  if (members['views.json']) return { photos: photosIn(members), strokes: viewsIn(members) }
  const name = Object.keys(members).find(member => /^clip\.\w+$/.test(member))
  const drawn = members['frame_strokes.json']
  if (!name || !drawn) return drawingOf(members, hasPhoto, readPicture)
  const type = VIDEO_TYPES[name.split('.')[1]!] ?? ''
  return { clip: new File([new Uint8Array(members[name]!)], name, { type }), strokes: parsed(drawn, frameFromWire) }
}

/** Return the many photos in a project by their own names, of which the service's pictures have one ending more. */
function photosIn(members: Record<string, Uint8Array>): File[] {
  const names = Object.keys(members).filter(member => /^photos\/[^/]+$/.test(member))
  return names.map(member => {
    const name = member.slice('photos/'.length)
    const own = name.replace(/\.png$/i, '')
    const type = typeByEnding(name) ?? ''
    return new File([new Uint8Array(members[member]!)], typeByEnding(own) ? own : name, { type })
  })
}

function typeByEnding(name: string): string | undefined {
  return TYPES[name.slice(name.lastIndexOf('.') + 1).toLowerCase()]
}

function viewsIn(members: Record<string, Uint8Array>): Strokes {
  const strokes = parsed(members['views.json']!, viewsFromWire)
  const edits = members['edits.json'] && parsed(members['edits.json'], editsFrom)
  return { ...strokes, ...(edits?.length && { edits }) }
}

function editsFrom(value: unknown): readonly Edit[] {
  const { edits } = value as { readonly edits?: unknown }
  if (!Array.isArray(edits)) throw new TypeError('no list of edits')
  return edits as Edit[] // the service checks them, as it does settings
}

/** Return the drawing in a project: strokes over a photo, or sketches. */
async function drawingOf(
  members: Record<string, Uint8Array>,
  hasPhoto: boolean,
  readPicture: ReadPicture,
): Promise<Drawn> {
  const json = members['strokes.json']
  const [front, side] = await Promise.all(SHEETS.map(sheet => sketchOf(members, sheet, readPicture)))
  if (!front && !(json && hasPhoto)) throw new PageFault(text.faults.projectIncomplete)
  return pairSketches(front ?? { strokes: strokesOf(json!) }, side ?? null)
}

async function sketchOf(
  members: Record<string, Uint8Array>,
  sheet: SheetName,
  readPicture: ReadPicture,
): Promise<SketchFile | null> {
  const json = members[`${sheet}.json`]
  const drawing = picture(members[`${sheet}.png`])
  return json ? parsed(json, sketchFrom) : drawing && (await readPicture(drawing))
}

function picture(bytes: Uint8Array | undefined, type = 'image/png'): Blob | null {
  return bytes ? new Blob([new Uint8Array(bytes)], { type }) : null
}

async function unzip(file: Blob): Promise<Record<string, Uint8Array>> {
  const bytes = new Uint8Array(await file.arrayBuffer())
  try {
    return unzipSync(bytes)
  } catch {
    throw new PageFault(text.faults.projectUnreadable)
  }
}

function strokesOf(json: Uint8Array): Strokes {
  return parsed(json, fromWire)
}

function parsed<T>(json: Uint8Array, read: (value: unknown) => T): T {
  try {
    return read(JSON.parse(strFromU8(json)))
  } catch {
    throw new PageFault(text.faults.projectUnreadable)
  }
}

/** Return the settings as they are; the service checks their values. */
function settingsOf(json: Uint8Array | undefined): Partial<Settings> & { seed?: number } {
  try {
    return json ? JSON.parse(strFromU8(json)) : {}
  } catch {
    throw new PageFault(text.faults.projectUnreadable)
  }
}
