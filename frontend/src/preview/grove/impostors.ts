import {
  HalfFloatType,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LinearMipmapLinearFilter,
  Mesh,
  OrthographicCamera,
  PlaneGeometry,
  Scene,
  ShaderMaterial,
  type Texture,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three'
import type { Kind } from './kind'
import { lightsOf } from './lit'
import type { Planted } from './planting'

/** From how many sides each kind is pictured, and how large a picture is, px. */
const SIDES = 8
const CELL = 160

const VERTEX = `
  attribute vec4 place;
  attribute vec2 look;
  uniform float rows;
  varying vec2 vUv;
  void main() {
    vec3 toCamera = cameraPosition - vec3(place.x, 0.0, place.y);
    float angle = atan(toCamera.x, toCamera.z);
    vec3 across = vec3(cos(angle), 0.0, -sin(angle));
    vec3 corner = vec3(place.x, 0.0, place.y) + across * position.x * place.z + vec3(0.0, (position.y + 0.5) * place.z, 0.0);
    float side = floor(mod((angle - place.w) / 6.283185307 * ${SIDES}.0 + 0.5, ${SIDES}.0));
    vUv = vec2((side + position.x + 0.5) / ${SIDES}.0, (look.x + position.y + 0.5) / rows);
    gl_Position = projectionMatrix * viewMatrix * vec4(corner, 1.0);
  }`
const FRAGMENT = `
  uniform sampler2D pictures;
  varying vec2 vUv;
  void main() {
    vec4 seen = texture2D(pictures, vUv);
    if (seen.a < 0.35) discard;
    gl_FragColor = vec4(seen.rgb / seen.a, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`

/** Return how high and wide a kind's picture is, metres: the tree stands on its lower edge, in its middle. */
function sizeOf({ height, radius }: Kind): number {
  return Math.max(height, 2 * radius) * 1.02
}

/** Trees far away, as pictures that face the camera: one draw call for all. */
export class Impostors {
  readonly mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>
  private readonly pictures: WebGLRenderTarget
  private readonly places: InstancedBufferAttribute
  private readonly looks: InstancedBufferAttribute

  constructor(
    renderer: WebGLRenderer,
    private readonly kinds: readonly Kind[],
    most: number,
    dark: boolean,
  ) {
    this.pictures = picturesOf(renderer, kinds, dark)
    const geometry = new InstancedBufferGeometry()
    const plane = new PlaneGeometry(1, 1)
    geometry.setAttribute('position', plane.getAttribute('position'))
    geometry.setIndex(plane.index)
    this.places = new InstancedBufferAttribute(new Float32Array(most * 4), 4)
    this.looks = new InstancedBufferAttribute(new Float32Array(most * 2), 2)
    geometry.setAttribute('place', this.places)
    geometry.setAttribute('look', this.looks)
    const uniforms = { pictures: { value: this.pictures.texture as Texture }, rows: { value: kinds.length } }
    this.mesh = new Mesh(geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms }))
    this.mesh.frustumCulled = false
  }

  /** Show these trees. */
  show(trees: readonly Planted[]): void {
    trees.forEach(({ kind, x, z, turn, size }, at) => {
      this.places.setXYZW(at, x, z, sizeOf(this.kinds[kind]!) * size, turn)
      this.looks.setXY(at, kind, 0)
    })
    this.places.needsUpdate = true
    this.looks.needsUpdate = true
    this.mesh.geometry.instanceCount = trees.length
    this.mesh.visible = trees.length > 0
  }

  dispose(): void {
    this.pictures.dispose()
    this.mesh.geometry.dispose()
    this.mesh.material.dispose()
  }
}

/** Draw every kind from all sides into one texture: a row for each kind, a column for each side. */
function picturesOf(renderer: WebGLRenderer, kinds: readonly Kind[], dark: boolean): WebGLRenderTarget {
  const target = new WebGLRenderTarget(SIDES * CELL, kinds.length * CELL, {
    type: HalfFloatType,
    generateMipmaps: true,
    minFilter: LinearMipmapLinearFilter,
  })
  target.scissorTest = true
  renderer.setClearColor(0x000000, 0)
  kinds.forEach((kind, row) => {
    const scene = new Scene().add(...kind.near.map(({ geometry, material }) => new Mesh(geometry, material)))
    scene.add(...lightsOf(dark))
    for (const part of scene.children) part.frustumCulled = false
    for (let side = 0; side < SIDES; side++) {
      target.viewport.set(side * CELL, row * CELL, CELL, CELL)
      target.scissor.copy(target.viewport)
      renderer.setRenderTarget(target)
      renderer.render(scene, cameraAt(side, sizeOf(kind)))
    }
  })
  renderer.setRenderTarget(null)
  return target
}

function cameraAt(side: number, size: number): OrthographicCamera {
  const camera = new OrthographicCamera(-size / 2, size / 2, size / 2, -size / 2, 0.01, 4 * size)
  const angle = (2 * Math.PI * side) / SIDES
  camera.position.set(2 * size * Math.sin(angle), size / 2, 2 * size * Math.cos(angle))
  camera.lookAt(0, size / 2, 0)
  return camera
}
