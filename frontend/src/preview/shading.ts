import {
  DoubleSide,
  MeshLambertMaterial,
  type MeshStandardMaterial,
  type Texture,
  type WebGLProgramParametersWithUniforms,
} from 'three'

/** Numbers that the shaders of a tree share and that change while it is shown. */
export interface Shades {
  /** 1 where no shadow map is drawn, and the canopy's own sun stands in for it. */
  baked: { value: number }
  /** How much the crown keeps the light off: 0 for a tree whose leaves are hidden. */
  canopy: { value: number }
  /** How many of the leaves have come, 0..1. */
  leafed: { value: number }
  /** The iteration of growth that is shown. */
  age: { value: number }
}

type Shader = WebGLProgramParametersWithUniforms

/** Iterations over which a new twig gets its thickness. */
export const THICKENING = 45

const LIT_VERTEX = 'attribute vec2 light;\nvarying vec2 vLight;'
const LIT_FRAGMENT = 'varying vec2 vLight;\nuniform float baked, canopy;'
const LIT_END = `#include <lights_fragment_end>
  vec2 reached = mix(vec2(1.0), smoothstep(0.0, 0.8, vLight), canopy);
  reflectedLight.indirectDiffuse *= 0.38 + 0.62 * reached.x;
  reflectedLight.directDiffuse *= mix(1.0, reached.y, mix(0.55, 1.0, baked));`

/* Leaves let the sun through: light wraps round them, and a crown glows where one looks against the sun. */
const LEAF_DIRECT = `
  float facing = dot(geometryNormal, directLight.direction);
  float against = pow(saturate(-dot(geometryViewDir, directLight.direction)), 3.0);
  vec3 through = material.diffuseColor * vec3(1.12, 1.08, 0.7) * (0.18 * saturate(0.4 - facing) + 0.7 * against);
  reflectedLight.directDiffuse += directLight.color * RECIPROCAL_PI
    * (material.diffuseColor * saturate((facing + 0.3) / 1.3) + through);`

/* A leaf that has not come is drawn together to one point. */
const YET_TO_COME = `
  if (fract(sin(float(gl_VertexID / 4) * 12.9898) * 43758.5453) > leafed) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);`

/** Bark as the GLB's textures have it, its relief too, lit through the canopy. */
export function barkMaterial(given: MeshStandardMaterial, gain: number, shades: Shades): MeshLambertMaterial {
  const { map, normalMap, normalScale } = given
  const material = new MeshLambertMaterial({ map, normalMap, normalScale })
  material.color.setScalar(gain)
  material.onBeforeCompile = shader => lightThroughCanopy(shader, shades)
  return material
}

/** Leaf cards: cut out, lit from both sides by their crown's normals, glowing against the sun. */
export function leafMaterial(
  map: Texture | null,
  look: { cut: number; gain: number },
  shades: Shades,
): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ map, vertexColors: true, alphaTest: look.cut, side: DoubleSide })
  material.color.setScalar(look.gain)
  material.onBeforeCompile = shader => {
    lightThroughCanopy(shader, shades)
    shader.uniforms.leafed = shades.leafed
    addToVertex(shader, 'uniform float leafed;', '')
    // At the very end, or bones would pull apart what is drawn together here.
    shader.vertexShader = shader.vertexShader.replace(
      '#include <project_vertex>',
      `#include <project_vertex>\n${YET_TO_COME}`,
    )
    shader.fragmentShader = shader.fragmentShader
      .replace(
        '#include <normal_fragment_begin>',
        'vec3 normal = normalize(vNormal);\nvec3 nonPerturbedNormal = normal;',
      )
      .replace('#include <lights_lambert_pars_fragment>', lambertWith(LEAF_DIRECT))
  }
  return material
}

/** Wood of the live skeleton: vertex colours; twigs thicken after they are born. */
export function woodMaterial(shades: Shades): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ vertexColors: true })
  material.onBeforeCompile = shader => {
    lightThroughCanopy(shader, shades)
    shader.uniforms.age = shades.age
    addToVertex(
      shader,
      'uniform float age;\nattribute vec2 stem;',
      `float thin = stem.x > 0.0 ? 1.0 - smoothstep(0.0, ${THICKENING}.0, age - stem.x) : 0.0;
      transformed -= objectNormal * stem.y * thin;`,
    )
  }
  return material
}

function lightThroughCanopy(shader: Shader, shades: Shades): void {
  shader.uniforms.baked = shades.baked
  shader.uniforms.canopy = shades.canopy
  addToVertex(shader, LIT_VERTEX, 'vLight = light;')
  shader.fragmentShader = shader.fragmentShader
    .replace('#include <common>', `#include <common>\n${LIT_FRAGMENT}`)
    .replace('#include <lights_fragment_end>', LIT_END)
}

/** Let a vertex shader declare something and do something more to each vertex, `transformed`. */
function addToVertex(shader: Shader, declared: string, done: string): void {
  shader.vertexShader = shader.vertexShader
    .replace('#include <common>', `#include <common>\n${declared}`)
    .replace('#include <begin_vertex>', `#include <begin_vertex>\n${done}`)
}

/** three's Lambert shading with direct light of our own. */
function lambertWith(direct: string): string {
  const given = 'const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir'
  const rest =
    'const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight'
  return `varying vec3 vViewPosition;
struct LambertMaterial { vec3 diffuseColor; float specularStrength; };
void RE_Direct_Leaf(const in IncidentLight directLight, ${given}, ${rest}) {${direct}
}
void RE_IndirectDiffuse_Leaf(const in vec3 irradiance, ${given}, ${rest}) {
  reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert(material.diffuseColor);
}
#define RE_Direct RE_Direct_Leaf
#define RE_IndirectDiffuse RE_IndirectDiffuse_Leaf`
}
