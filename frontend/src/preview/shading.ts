import {
  DoubleSide,
  MeshLambertMaterial,
  type MeshStandardMaterial,
  type Texture,
  type WebGLProgramParametersWithUniforms,
} from 'three'

/** Uniforms that the shaders of a tree share; they change while it is shown. */
export interface TreeUniforms {
  /** 1 where no shadow map is drawn: then the sunlight in the canopy darkens the tree instead. */
  baked: { value: number }
  /** How much the crown's leaves shade the tree: 0 where they are hidden, else 1. */
  canopy: { value: number }
  /** The share of the leaves that are shown, 0..1. */
  leafShare: { value: number }
  /** The iteration of growth that is shown. */
  iteration: { value: number }
}

type Shader = WebGLProgramParametersWithUniforms

/** Iterations over which a new twig reaches its thickness. */
export const THICKENING = 45

const LIT_VERTEX = 'attribute vec2 light;\nvarying vec2 vLight;'
const LIT_FRAGMENT = 'varying vec2 vLight;\nuniform float baked, canopy;'
const LIT_END = `#include <lights_fragment_end>
  vec2 reached = mix(vec2(1.0), smoothstep(0.0, 0.8, vLight), canopy);
  reflectedLight.indirectDiffuse *= 0.38 + 0.62 * reached.x;
  reflectedLight.directDiffuse *= mix(1.0, reached.y, mix(0.55, 1.0, baked));`

/* Leaves let sunlight through: it wraps around them, and a crown seen against the sun glows. */
const LEAF_DIRECT = `
  float facing = dot(geometryNormal, directLight.direction);
  float against = pow(saturate(-dot(geometryViewDir, directLight.direction)), 3.0);
  vec3 through = material.diffuseColor * vec3(1.12, 1.08, 0.7) * (0.18 * saturate(0.4 - facing) + 0.7 * against);
  reflectedLight.directDiffuse += directLight.color * RECIPROCAL_PI
    * (material.diffuseColor * saturate((facing + 0.3) / 1.3) + through);`

/* A leaf that is not shown yet shrinks to one point. */
const HIDE_LATER_LEAVES = `
  if (fract(sin(float(gl_VertexID / 4) * 12.9898) * 43758.5453) > leafShare) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);`

/** Return a material with the bark's textures and normal map of the GLB, lit through the canopy; `gain` brightens it. */
export function barkMaterial(
  original: MeshStandardMaterial,
  gain: number,
  uniforms: TreeUniforms,
): MeshLambertMaterial {
  const { map, normalMap, normalScale } = original
  const material = new MeshLambertMaterial({ map, normalMap, normalScale })
  material.color.setScalar(gain)
  material.onBeforeCompile = shader => lightThroughCanopy(shader, uniforms)
  return material
}

/** Return a material for leaf cards: cut out, lit from both sides by the crown's normals, glowing against the sun. */
export function leafMaterial(
  map: Texture | null,
  look: { alphaTest: number; gain: number },
  uniforms: TreeUniforms,
): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ map, vertexColors: true, alphaTest: look.alphaTest, side: DoubleSide })
  material.color.setScalar(look.gain)
  material.onBeforeCompile = shader => {
    lightThroughCanopy(shader, uniforms)
    shader.uniforms.leafShare = uniforms.leafShare
    addToVertex(shader, 'uniform float leafShare;', '')
    // After the bones, which would pull the shrunk leaf apart again.
    shader.vertexShader = shader.vertexShader.replace(
      '#include <project_vertex>',
      `#include <project_vertex>\n${HIDE_LATER_LEAVES}`,
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

/** Return a material for the live tree's wood: vertex colours; a twig thickens after its birth. */
export function woodMaterial(uniforms: TreeUniforms): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ vertexColors: true })
  material.onBeforeCompile = shader => {
    lightThroughCanopy(shader, uniforms)
    shader.uniforms.iteration = uniforms.iteration
    addToVertex(
      shader,
      'uniform float iteration;\nattribute vec2 bornRadius;',
      `float thin = bornRadius.x > 0.0 ? 1.0 - smoothstep(0.0, ${THICKENING}.0, iteration - bornRadius.x) : 0.0;
      transformed -= objectNormal * bornRadius.y * thin;`,
    )
  }
  return material
}

function lightThroughCanopy(shader: Shader, uniforms: TreeUniforms): void {
  shader.uniforms.baked = uniforms.baked
  shader.uniforms.canopy = uniforms.canopy
  addToVertex(shader, LIT_VERTEX, 'vLight = light;')
  shader.fragmentShader = shader.fragmentShader
    .replace('#include <common>', `#include <common>\n${LIT_FRAGMENT}`)
    .replace('#include <lights_fragment_end>', LIT_END)
}

/** Add declarations, and statements that may change each vertex (`transformed`), to a vertex shader. */
function addToVertex(shader: Shader, declarations: string, statements: string): void {
  shader.vertexShader = shader.vertexShader
    .replace('#include <common>', `#include <common>\n${declarations}`)
    .replace('#include <begin_vertex>', `#include <begin_vertex>\n${statements}`)
}

/** Return three's Lambert shading with other code for direct light. */
function lambertWith(directLight: string): string {
  const geometry = 'const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir'
  const rest =
    'const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight'
  return `varying vec3 vViewPosition;
struct LambertMaterial { vec3 diffuseColor; float specularStrength; };
void RE_Direct_Leaf(const in IncidentLight directLight, ${geometry}, ${rest}) {${directLight}
}
void RE_IndirectDiffuse_Leaf(const in vec3 irradiance, ${geometry}, ${rest}) {
  reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert(material.diffuseColor);
}
#define RE_Direct RE_Direct_Leaf
#define RE_IndirectDiffuse RE_IndirectDiffuse_Leaf`
}
