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

/** Colours of sky and ground, and the strength of the light, for one scheme. */
export interface Scheme {
  zenith: string
  horizon: string
  floor: string
  meadow: string
  shadow: string
  sun: string
  sky: string
  sunlight: number
  skylight: number
}

/** A bright morning on paper. */
export const LIGHT: Scheme = {
  zenith: '#c3d6dc',
  horizon: '#f7f1e3',
  floor: '#e4dfcb',
  meadow: '#a9ae7c',
  shadow: '#3b4232',
  sun: '#fff5e8',
  sky: '#e1ebf0',
  sunlight: 4,
  skylight: 2.3,
}
/** Late light on a dark desk. */
export const DARK: Scheme = {
  zenith: '#10171b',
  horizon: '#424d49',
  floor: '#1e2621',
  meadow: '#4f5c3a',
  shadow: '#0a0e0b',
  sun: '#ffeacd',
  sky: '#bccbd6',
  sunlight: 4.2,
  skylight: 2.1,
}

const DITHER = 'fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) / 255.0'

/** The sky above and the floor below the horizon, drawn behind all else. */
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
        meadow: colour(),
        horizon: { value: 0 },
        level: { value: 0 },
      },
      vertexShader: 'varying vec2 at;\nvoid main() { at = position.xy; gl_Position = vec4(position.xy, 1.0, 1.0); }',
      fragmentShader: `varying vec2 at;
        uniform vec3 zenith, haze, floor, meadow;
        uniform float horizon, level;
        void main() {
          float above = at.y - horizon;
          vec3 sky = mix(haze, zenith, smoothstep(0.0, 2.0, above - 0.12 * at.x));
          vec3 ground = mix(haze, floor, smoothstep(0.0, 0.55, -above));
          float near = exp(-at.x * at.x * 1.6) * smoothstep(0.45, 0.0, -above);
          ground = mix(ground, meadow, level * near * 0.75);
          vec3 colour = mix(ground, sky, smoothstep(-0.012, 0.012, above));
          colour *= 1.0 - 0.05 * dot(at, at);
          gl_FragColor = vec4(colour + ${DITHER}, 1.0);
        }`,
      depthTest: false,
      depthWrite: false,
    })
    const whole = new BufferGeometry()
    whole.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3))
    this.mesh = new Mesh(whole, this.material)
    this.mesh.frustumCulled = false
    this.mesh.renderOrder = -2
  }

  /** Where the horizon is, and how far (0..1) one sees the ground from its edge, so that it hides its meadow. */
  set(horizon: number, level: number): void {
    this.material.uniforms.horizon!.value = horizon
    this.material.uniforms.level!.value = level
  }

  paint(scheme: Scheme): void {
    for (const [name, colour] of [
      ['zenith', scheme.zenith],
      ['haze', scheme.horizon],
      ['floor', scheme.floor],
      ['meadow', scheme.meadow],
    ] as const)
      asShown(this.material.uniforms[name]!.value as Color, colour)
  }
}

/** A round of meadow under the tree that takes its shadow and fades into the floor like the edge of a wash. */
export class Meadow {
  readonly mesh: Mesh
  private readonly uniforms = {
    meadow: { value: new Color() },
    dark: { value: new Color() },
    fallen: { value: pictureOf(new Uint8Array(1), 1) },
    baked: { value: 0 },
    middle: { value: new Vector2() },
  }

  constructor() {
    const material = new ShadowMaterial({ depthWrite: false })
    material.onBeforeCompile = shader => {
      Object.assign(shader.uniforms, this.uniforms)
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nvarying vec2 vRound;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nvRound = position.xy;')
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
    asShown(this.uniforms.meadow.value, scheme.meadow)
    asShown(this.uniforms.dark.value, scheme.shadow)
  }

  /** Lie under a tree whose root stands at the origin. */
  lie({ centre, reach }: { centre: readonly [number, number]; reach: number }): void {
    this.mesh.position.set(centre[0], -0.001, centre[1])
    this.mesh.scale.setScalar(reach)
    this.uniforms.middle.value.set(-centre[0] / reach, centre[1] / reach)
  }

  /** Take a painted shadow, `side` x `side` bytes, in the place of a shadow map. */
  shade(picture: Uint8Array, side: number): void {
    this.uniforms.fallen.value.dispose()
    this.uniforms.fallen.value = pictureOf(picture, side)
    this.uniforms.baked.value = 1
  }
}

const GROUND_HEAD = `varying vec2 vRound;
  uniform vec3 meadow, dark;
  uniform sampler2D fallen;
  uniform float baked;
  uniform vec2 middle;
  float ripple(vec2 p) {
    float a = atan(p.y, p.x);
    return 0.05 * sin(3.0 * a + 0.6) + 0.03 * sin(7.0 * a + 2.1) + 0.012 * sin(17.0 * a);
  }`
const GROUND_COLOUR = `
  float away = length(vRound) * (1.0 + ripple(vRound));
  float wash = 0.75 * (1.0 - smoothstep(0.15, 0.97, away));
  float shaded = mix((1.0 - getShadowMask()) / 0.6, texture2D(fallen, vec2(vRound.x, -vRound.y) * 0.5 + 0.5).r, baked);
  float foot = 0.5 * exp(-dot(vRound - middle, vRound - middle) * 220.0);
  float shade = max(0.52 * shaded, foot) * (1.0 - smoothstep(0.6, 0.98, away));
  float cover = 1.0 - (1.0 - wash) * (1.0 - shade);
  gl_FragColor = vec4((meadow * wash * (1.0 - shade) + dark * shade) / max(cover, 1e-3), cover);`

function pictureOf(bytes: Uint8Array, side: number): DataTexture {
  const texture = new DataTexture(bytes as Uint8Array<ArrayBuffer>, side, side, RedFormat)
  texture.magFilter = LinearFilter
  texture.unpackAlignment = 1
  texture.needsUpdate = true
  return texture
}

/** A colour to be written as it is, past three's conversion to linear light. */
function asShown(colour: Color, css: string): void {
  colour.set(css).convertLinearToSRGB()
}
