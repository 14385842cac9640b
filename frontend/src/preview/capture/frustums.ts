import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  SRGBColorSpace,
  type Texture,
  TextureLoader,
} from 'three'
import type { CameraInfo } from '../../api/types'
import { type Pose, projected, type Vec3, type Viewport } from '../camera'
import { pictureCorners, standpoint } from './photoCamera'
import { IDENTITY, moved, type Similarity } from './similarity'

/** How deep a photo's frustum is, as a share of the height that photos show; that of the chosen photo is larger. */
const DEPTH = 0.13
const CHOSEN_DEPTH = 0.21
/** The colours of lines, by the page's scheme, and of the chosen photo. */
const LINES = { light: '#4b5a4e', dark: '#aebbb0' }
const CHOSEN = '#e07a1f'
const PLAIN = '#9fae9f'
/** Corners of two triangles that fill a picture, and where its texture stands there. */
const FILL = [0, 3, 2, 0, 2, 1]
const TEXTURE = new Float32Array([0, 1, 1, 1, 1, 0, 0, 0])

/** The cameras of photos, each as a small pyramid with its photo at the base; in the capture's frame. */
export class Frustums {
  readonly group = new Group()
  private readonly pictures = new Map<string, { readonly url: string; readonly texture: Texture }>()
  private readonly plain = new LineBasicMaterial({ toneMapped: false, transparent: true, opacity: 0.75 })
  private readonly marked = new LineBasicMaterial({ color: CHOSEN, toneMapped: false })
  private cameras: readonly CameraInfo[] = []
  private unit = 1
  private chosen: string | null = null

  /** `changed` is called when a photo's picture has arrived. */
  constructor(private readonly changed: () => void) {}

  /** Show cameras; `unit` is the height that photos show at the tree. */
  show(cameras: readonly CameraInfo[], unit: number): void {
    this.cameras = cameras
    this.unit = unit
    this.build()
  }

  /** Mark a photo. */
  choose(photo: string | null): void {
    if (photo === this.chosen) return
    this.chosen = photo
    this.build()
  }

  /** Set the addresses of small pictures, by the photos' names. */
  setPictures(pictures: ReadonlyMap<string, string>): void {
    const fresh = [...pictures].filter(([photo, url]) => this.pictures.get(photo)?.url !== url)
    for (const [photo, url] of fresh) {
      this.pictures.get(photo)?.texture.dispose()
      const texture = new TextureLoader().load(url, this.changed)
      texture.colorSpace = SRGBColorSpace
      this.pictures.set(photo, { url, texture })
    }
    if (fresh.length) this.build()
  }

  paint(dark: boolean): void {
    this.plain.color.set(dark ? LINES.dark : LINES.light)
  }

  /** Return the photo whose frustum is shown at a place (CSS px), the nearest one; null where there is none. */
  at(place: readonly [number, number], world: Similarity, pose: Pose, viewport: Viewport): string | null {
    let [nearest, least]: [string | null, number] = [null, Number.POSITIVE_INFINITY]
    for (const camera of this.cameras) {
      const corners = this.cornersOf(camera).map(corner => projected(pose, moved(world, corner), viewport))
      const depth = corners[0]![2]
      if (corners.every(corner => corner[2] > 0) && depth < least && isInside(place, corners))
        [nearest, least] = [camera.photo, depth]
    }
    return nearest
  }

  dispose(): void {
    this.clear()
    for (const { texture } of this.pictures.values()) texture.dispose()
    this.pictures.clear()
    this.plain.dispose()
    this.marked.dispose()
  }

  private cornersOf(camera: CameraInfo): Vec3[] {
    const depth = (camera.photo === this.chosen ? CHOSEN_DEPTH : DEPTH) * this.unit
    return pictureCorners(camera, standpoint(camera, IDENTITY), depth)
  }

  private build(): void {
    this.clear()
    const others = this.cameras.filter(({ photo }) => photo !== this.chosen)
    const chosen = this.cameras.filter(({ photo }) => photo === this.chosen)
    this.group.add(this.linesOf(others, this.plain), this.linesOf(chosen, this.marked))
    for (const camera of this.cameras) this.group.add(this.pictureOf(camera))
  }

  private linesOf(cameras: readonly CameraInfo[], material: LineBasicMaterial): LineSegments {
    const ends = cameras.flatMap(camera => {
      const { centre } = standpoint(camera, IDENTITY)
      const corners = this.cornersOf(camera)
      return corners.flatMap((corner, at) => [...centre, ...corner, ...corner, ...corners[(at + 1) % 4]!])
    })
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(Float32Array.from(ends), 3))
    return new LineSegments(geometry, material)
  }

  private pictureOf(camera: CameraInfo): Mesh {
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(Float32Array.from(this.cornersOf(camera).flat()), 3))
    geometry.setAttribute('uv', new BufferAttribute(TEXTURE, 2))
    geometry.setIndex(FILL)
    const map = this.pictures.get(camera.photo)?.texture ?? null
    const look = { side: DoubleSide, toneMapped: false, transparent: true, opacity: map ? 0.95 : 0.35 }
    return new Mesh(geometry, new MeshBasicMaterial({ ...look, map, color: map ? '#ffffff' : PLAIN }))
  }

  private clear(): void {
    for (const part of this.group.children as (Mesh | LineSegments)[]) {
      part.geometry.dispose()
      if (part instanceof Mesh) (part.material as MeshBasicMaterial).dispose()
    }
    this.group.clear()
  }
}

/** Return whether a place lies inside a polygon, by how often its edges cross the place's height right of it. */
function isInside([x, y]: readonly [number, number], corners: readonly (readonly [number, number, number])[]): boolean {
  let inside = false
  corners.forEach(([fromX, fromY], at) => {
    const [toX, toY] = corners[(at + 1) % corners.length]!
    if (fromY > y !== toY > y && x < fromX + ((y - fromY) / (toY - fromY)) * (toX - fromX)) inside = !inside
  })
  return inside
}
