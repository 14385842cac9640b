import {
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  DataTexture,
  LinearFilter,
  Mesh,
  RedFormat,
  ShaderMaterial,
  ShadowMaterial,
  Vector2,
} from 'three'

/** Colours of sky, ground and light, and the light's strength, for one colour scheme of the page. */
export interface Scheme {
  zenith: string
  horizon: string
  floor: string
  grass: string
  shadow: string
  sun: string
  sky: string
  sunlight: number
  skylight: number
}

export const LIGHT: Scheme = {
  zenith: '#c3d6dc',
  horizon: '#f7f1e3',
  floor: '#e4dfcb',
  grass: '#a9ae7c',
  shadow: '#3b4232',
  sun: '#fff5e8',
  sky: '#e1ebf0',
  sunlight: 4,
  skylight: 2.3,
}
export const DARK: Scheme = {
  zenith: '#10171b',
  horizon: '#424d49',
  floor: '#1e2621',
  grass: '#4f5c3a',
  shadow: '#0a0e0b',
  sun: '#ffeacd',
  sky: '#bccbd6',
  sunlight: 4.2,
  skylight: 2.1,
}

/** Noise of one level, which hides the bands of a smooth gradient. */
const DITHER = 'fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) / 255.0'

/** The sky above the horizon and the floor below it, drawn behind everything else. */
export class Backdrop {
  readonly mesh: Mesh
  private readonly material: ShaderMaterial

  constructor() {
    const colour = () => ({ value: new Color() })
    this.material = new ShaderMaterial({
      uniforms: {
        zenith: colour(),
        haze: colour(),
        floor: colour(),
        grass: colour(),
        horizon: { value: 0 },
        grassShare: { value: 0 },
      },
      vertexShader: 'varying vec2 at;\nvoid main() { at = position.xy; gl_Position = vec4(position.xy, 1.0, 1.0); }',
      fragmentShader: `varying vec2 at;
        uniform vec3 zenith, haze, floor, grass;
        uniform float horizon, grassShare;
        void main() {
          float above = at.y - horizon;
          vec3 sky = mix(haze, zenith, smoothstep(0.0, 2.0, above - 0.12 * at.x));
          vec3 ground = mix(haze, floor, smoothstep(0.0, 0.55, -above));
          float near = exp(-at.x * at.x * 1.6) * smoothstep(0.45, 0.0, -above);
          ground = mix(ground, grass, grassShare * near * 0.75);
          vec3 colour = mix(ground, sky, smoothstep(-0.012, 0.012, above));
          colour *= 1.0 - 0.05 * dot(at, at);
          gl_FragColor = vec4(colour + ${DITHER}, 1.0);
        }`,
      depthTest: false,
      depthWrite: false,
    })
    const triangle = new BufferGeometry()
    triangle.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3))
    this.mesh = new Mesh(triangle, this.material)
    this.mesh.frustumCulled = false
    this.mesh.renderOrder = -2
  }

  /** Set the horizon's height (-1 bottom to 1 top), and how much grass to paint, 0..1: 1 where the disc is seen edge-on. */
  set(horizon: number, grassShare: number): void {
    this.material.uniforms.horizon!.value = horizon
    this.material.uniforms.grassShare!.value = grassShare
  }

  paint(scheme: Scheme): void {
    for (const [name, colour] of [
      ['zenith', scheme.zenith],
      ['haze', scheme.horizon],
      ['floor', scheme.floor],
      ['grass', scheme.grass],
    ] as const)
      setUnconverted(this.material.uniforms[name]!.value as Color, colour)
  }
}

/** A disc of grass under the tree that shows its shadow; its uneven edge fades into the floor. */
export class Ground {
  readonly mesh: Mesh
  private readonly uniforms = {
    grass: { value: new Color() },
    shadowColour: { value: new Color() },
    bakedShadow: { value: textureOf(new Uint8Array(1), 1) },
    baked: { value: 0 },
    root: { value: new Vector2() },
  }

  constructor() {
    const material = new ShadowMaterial({ depthWrite: false })
    material.onBeforeCompile = shader => {
      Object.assign(shader.uniforms, this.uniforms)
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nvarying vec2 vDisc;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nvDisc = position.xy;')
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', `#include <common>\n${GROUND_HEAD}`)
        .replace('gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );', GROUND_COLOUR)
        .replace('#include <tonemapping_fragment>', '')
        .replace('#include <colorspace_fragment>', '')
    }
    this.mesh = new Mesh(new CircleGeometry(1, 64), material)
    this.mesh.rotation.x = -Math.PI / 2
    this.mesh.receiveShadow = true
    this.mesh.renderOrder = -1
  }

  paint(scheme: Scheme): void {
    setUnconverted(this.uniforms.grass.value, scheme.grass)
    setUnconverted(this.uniforms.shadowColour.value, scheme.shadow)
  }

  /** Set the centre [x, z] and radius, world units; the tree's root is at the origin. */
  place({ centre, radius }: { centre: readonly [number, number]; radius: number }): void {
    this.mesh.position.set(centre[0], -0.001, centre[1])
    this.mesh.scale.setScalar(radius)
    this.uniforms.root.value.set(-centre[0] / radius, centre[1] / radius)
  }

  /** Show a baked shadow, `side` x `side` bytes, in place of a shadow map. */
  setBakedShadow(picture: Uint8Array, side: number): void {
    this.uniforms.bakedShadow.value.dispose()
    this.uniforms.bakedShadow.value = textureOf(picture, side)
    this.uniforms.baked.value = 1
  }
}

const GROUND_HEAD = `varying vec2 vDisc;
  uniform vec3 grass, shadowColour;
  uniform sampler2D bakedShadow;
  uniform float baked;
  uniform vec2 root;
  float ripple(vec2 p) {
    float a = atan(p.y, p.x);
    return 0.05 * sin(3.0 * a + 0.6) + 0.03 * sin(7.0 * a + 2.1) + 0.012 * sin(17.0 * a);
  }`
const GROUND_COLOUR = `
  float away = length(vDisc) * (1.0 + ripple(vDisc));
  float grassAlpha = 0.75 * (1.0 - smoothstep(0.15, 0.97, away));
  float shaded = mix((1.0 - getShadowMask()) / 0.6, texture2D(bakedShadow, vec2(vDisc.x, -vDisc.y) * 0.5 + 0.5).r, baked);
  float foot = 0.5 * exp(-dot(vDisc - root, vDisc - root) * 220.0);
  float shade = max(0.52 * shaded, foot) * (1.0 - smoothstep(0.6, 0.98, away));
  float cover = 1.0 - (1.0 - grassAlpha) * (1.0 - shade);
  gl_FragColor = vec4((grass * grassAlpha * (1.0 - shade) + shadowColour * shade) / max(cover, 1e-3), cover);`

function textureOf(bytes: Uint8Array, side: number): DataTexture {
  const texture = new DataTexture(bytes as Uint8Array<ArrayBuffer>, side, side, RedFormat)
  texture.magFilter = LinearFilter
  texture.unpackAlignment = 1
  texture.needsUpdate = true
  return texture
}

/** Set a colour that a shader writes as it is: without three's conversion to linear light. */
function setUnconverted(colour: Color, css: string): void {
  colour.set(css).convertLinearToSRGB()
}
