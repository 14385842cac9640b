import {
  CircleGeometry,
  Color,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  ShaderMaterial,
} from 'three'
import { DARK, LIGHT } from '../backdrop'
import type { Kind } from './kind'
import type { Planted } from './planting'

const VERTEX =
  'varying vec2 vUv; void main() { vUv = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }'
const FRAGMENT = `uniform vec3 grass, far; varying vec2 vUv;
  void main() {
    gl_FragColor = vec4(mix(grass, far, smoothstep(0.1, 1.0, 2.0 * distance(vUv, vec2(0.5)))), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`
/** How far the ground goes, metres. */
const REACH = 1500

/** The ground, and a soft shadow under each tree: two draw calls. */
export class Meadow {
  readonly parts: readonly Object3D[]
  private readonly ground: Mesh<CircleGeometry, ShaderMaterial>
  private readonly shadows: InstancedMesh<CircleGeometry, MeshBasicMaterial>

  constructor(most: number, dark: boolean) {
    const scheme = dark ? DARK : LIGHT
    const uniforms = { grass: { value: new Color(scheme.grass) }, far: { value: new Color(scheme.horizon) } }
    const material = new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms })
    this.ground = new Mesh(new CircleGeometry(REACH, 64).rotateX(-Math.PI / 2), material)
    const shade = new MeshBasicMaterial({ color: scheme.shadow, transparent: true, opacity: 0.28, depthWrite: false })
    this.shadows = new InstancedMesh(new CircleGeometry(1, 24).rotateX(-Math.PI / 2), shade, most)
    this.shadows.frustumCulled = false
    this.parts = [this.ground, this.shadows]
  }

  /** Lay a shadow under each tree. */
  show(trees: readonly Planted[], kinds: readonly Kind[]): void {
    trees.forEach(({ kind, x, z, size }, at) => {
      const radius = 0.75 * kinds[kind]!.radius * size
      this.shadows.setMatrixAt(at, new Matrix4().makeScale(radius, 1, radius).setPosition(x, 0.02, z))
    })
    this.shadows.count = trees.length
    this.shadows.instanceMatrix.needsUpdate = true
  }

  dispose(): void {
    for (const { geometry, material } of [this.ground, this.shadows]) {
      geometry.dispose()
      material.dispose()
    }
  }
}
