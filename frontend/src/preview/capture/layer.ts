import { Group, type Material, type Mesh, type Points } from 'three'
import type { CameraInfo } from '../../api/types'
import type { Box, Pose, Rect, Vec3, Viewport } from '../camera'
import { unitsPerMetre } from '../camera'
import type { Content } from '../content'
import { Frustums } from './frustums'
import { type Measured, PARTS, type Part } from './measured'
import { cameraPose, pictureRect } from './photoCamera'
import { alignment, boxOfCameras, heightInPhotos, lookedAt, placeTraced, placeUntraced } from './placement'
import { after, IDENTITY, type Similarity, scaling } from './similarity'
import { branchMesh, cloudPoints, crownMesh } from './surfaces'

/** How far from what the cameras look at points are shown, in heights that photos show. */
const CLOUD_REACH = 1.5
/** A tree's middle, about which its photos' cameras turn, as a share of its height. */
const MIDDLE = 0.5

/** What is shown of a capture unless the user chose otherwise, by what else is shown. */
const FIRST: Readonly<Record<'alone' | 'traced' | 'live' | 'model' | 'edited', readonly Part[]>> = {
  alone: ['cameras', 'cloud'],
  traced: ['cameras', 'crown', 'branches'],
  live: ['cameras', 'crown'],
  model: ['cameras'],
  edited: ['crown'],
}

/** What many photos say about a tree, in the preview's world: cameras, cloud, crown and branches. */
export class CaptureLayer {
  readonly group = new Group()
  /** The photo that is chosen. */
  chosen: string | null = null
  private readonly frustums: Frustums
  private measured: Measured | null = null
  private readonly parts: Partial<Record<Part, Mesh | Points>> = {}
  private readonly wanted: Partial<Record<Part, boolean>> = {}
  private world: Similarity = IDENTITY
  private content: Content | null = null
  private edited = false

  /** `changed` is called when a picture has arrived. */
  constructor(changed: () => void) {
    this.frustums = new Frustums(changed)
    this.group.matrixAutoUpdate = false
    this.group.add(this.frustums.group)
  }

  /** Whether there is anything of a capture. */
  get isEmpty(): boolean {
    return !this.measured?.cameras.length
  }

  /** Leads from the capture's frame to the preview's world. */
  get toWorld(): Similarity {
    return this.world
  }

  /** Show another capture, or the same one with other parts; null shows none. */
  show(measured: Measured | null): void {
    const before = this.measured
    this.measured = measured?.cameras.length ? measured : null
    const unit = this.measured ? heightInPhotos(this.measured.cameras) : 1
    if (measured?.cameras !== before?.cameras) this.frustums.show(this.measured?.cameras ?? [], unit)
    const { cloud, tree, cameras } = this.measured ?? { cloud: null, tree: null, cameras: [] }
    if (cloud !== (before?.cloud ?? null))
      this.replace('cloud', cloud && cloudPoints(cloud, lookedAt(cameras), CLOUD_REACH * unit))
    if (tree?.crown !== before?.tree?.crown) this.replace('crown', tree && crownMesh(tree.crown))
    if (tree?.branches !== before?.tree?.branches) this.replace('branches', tree && branchMesh(tree.branches, unit))
    this.place(this.content)
  }

  /** Set the addresses of the photos' small pictures, by their names. */
  setPictures(pictures: ReadonlyMap<string, string>): void {
    this.frustums.setPictures(pictures)
  }

  /** Mark a photo. */
  choose(photo: string | null): void {
    this.chosen = photo
    this.frustums.choose(photo)
  }

  /** Put it where a tree is shown, or where it stands best without one. */
  place(content: Content | null): void {
    this.content = content
    if (this.measured) this.world = worldOf(this.measured, content)
    const [a, b, c] = this.world
    this.group.matrix.set(...a, ...b, ...c, 0, 0, 0, 1)
    this.group.matrixWorldNeedsUpdate = true
    this.applyParts()
  }

  /** Show or hide a part. */
  setPart(part: Part, shown: boolean): void {
    this.wanted[part] = shown
    this.applyParts()
  }

  /** Which parts there are, and whether they are shown; null where there is no capture. */
  get shownParts(): Readonly<Partial<Record<Part, boolean>>> | null {
    if (!this.measured) return null
    const there = PARTS.filter(part => part === 'cameras' || this.parts[part])
    return Object.fromEntries(there.map(part => [part, this.isShown(part)]))
  }

  /** Leave the branches out while they are edited: they are drawn over everything then. */
  setEdited(on: boolean): void {
    this.edited = on
    this.applyParts()
  }

  /** Show the cameras or not, whatever the user chose: from where one stands it would hide the tree. */
  set standsInPhoto(on: boolean) {
    this.frustums.group.visible = !on && this.isShown('cameras')
  }

  paint(dark: boolean): void {
    this.frustums.paint(dark)
  }

  /** Return the pose of the chosen photo's camera; null where it has none. */
  photoPose(viewport: Viewport): Pose | null {
    const camera = this.camera
    return camera && cameraPose(camera, this.world, this.middle, viewport)
  }

  /** Return where the chosen photo lies for its camera's pose, CSS px. */
  photoRect(pose: Pose, viewport: Viewport): Rect | null {
    const camera = this.camera
    return camera && pictureRect(camera, pose, viewport)
  }

  /** Return the photo whose camera is shown at a place, CSS px. */
  photoAt(place: readonly [number, number], pose: Pose, viewport: Viewport): string | null {
    return this.frustums.group.visible ? this.frustums.at(place, this.world, pose, viewport) : null
  }

  /** The box around its cameras and around where the tree is expected; null where there is no capture. */
  get box(): Box | null {
    return this.measured && boxOfCameras(this.measured.cameras, this.world)
  }

  dispose(): void {
    this.show(null)
    this.frustums.dispose()
  }

  private get camera(): CameraInfo | null {
    return this.measured?.cameras.find(({ photo }) => photo === this.chosen) ?? null
  }

  /** The point about which a photo's camera turns when the user turns it. */
  private get middle(): Vec3 {
    const { min, max } = this.content?.box ?? { min: [0, 0, 0] as const, max: [0, 0.9, 0] as const }
    return [(min[0] + max[0]) / 2, min[1] + (max[1] - min[1]) * MIDDLE, (min[2] + max[2]) / 2]
  }

  private isShown(part: Part): boolean {
    const alone = this.measured?.tree ? 'traced' : 'alone'
    const first = this.edited ? 'edited' : (this.content?.kind ?? alone)
    return this.wanted[part] ?? FIRST[first].includes(part)
  }

  private applyParts(): void {
    this.frustums.group.visible = this.isShown('cameras')
    for (const part of PARTS) if (this.parts[part]) this.parts[part].visible = this.isShown(part)
    if (this.parts.branches && this.edited) this.parts.branches.visible = false
  }

  private replace(part: Part, next: Mesh | Points | null): void {
    const before = this.parts[part]
    if (before) {
      this.group.remove(before)
      before.geometry.dispose()
      ;(before.material as Material).dispose()
      delete this.parts[part]
    }
    if (!next) return
    this.parts[part] = next
    this.group.add(next)
  }
}

/**
 * Return what leads from a capture's frame to the preview's world. A model's own cameras lead there, since the strokes and
 * the height may have changed since it was made.
 */
function worldOf({ cameras, front, tree }: Measured, content: Content | null): Similarity {
  const own = content?.cameras ? alignment(cameras, content.cameras) : null
  const metres = own ?? tree?.treeFromCapture
  if (!metres) return placeUntraced(cameras, front)
  return content ? after(scaling(unitsPerMetre(content.photo)), metres) : placeTraced(cameras, metres)
}
