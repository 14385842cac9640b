import { Group, InstancedMesh, Matrix4, Quaternion, Vector3 } from 'three'
import type { Part } from './kind'
import type { Planted } from './planting'

const UP = new Vector3(0, 1, 0)

/** Copies of one tree at one detail: a draw call for each of its parts. */
export class Copies {
  readonly group = new Group()
  private readonly meshes: readonly InstancedMesh[]

  constructor(parts: readonly Part[], most: number) {
    this.meshes = parts.map(({ geometry, material }) => new InstancedMesh(geometry, material, most))
    for (const mesh of this.meshes) mesh.frustumCulled = false
    this.group.add(...this.meshes)
    this.show([])
  }

  /** Show these trees. */
  show(trees: readonly Planted[]): void {
    this.group.visible = trees.length > 0
    for (const mesh of this.meshes) {
      trees.forEach((tree, at) => {
        mesh.setMatrixAt(at, placeOf(tree))
      })
      mesh.count = trees.length
      mesh.instanceMatrix.needsUpdate = true
    }
  }

  dispose(): void {
    for (const mesh of this.meshes) {
      mesh.geometry.dispose()
      mesh.dispose()
    }
  }
}

/** Return the matrix of a tree's place, turn and size. */
export function placeOf({ x, z, turn, size }: Planted): Matrix4 {
  const turned = new Quaternion().setFromAxisAngle(UP, turn)
  return new Matrix4().compose(new Vector3(x, 0, z), turned, new Vector3(size, size, size))
}
