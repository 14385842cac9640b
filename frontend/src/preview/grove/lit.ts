import { type ColorRepresentation, DirectionalLight, HemisphereLight, type Object3D } from 'three'
import { DARK, LIGHT } from '../backdrop'
import type { TreeUniforms } from '../shading'
import { SUN } from '../sun'

/** Uniforms of trees that throw no shadow map, with all their leaves. */
export function stillUniforms(): TreeUniforms {
  return { baked: { value: 1 }, canopy: { value: 1 }, leafShare: { value: 1 }, iteration: { value: 0 } }
}

/** Return the sun and the sky of the page's light or dark scheme. */
export function lightsOf(dark: boolean): Object3D[] {
  const scheme = dark ? DARK : LIGHT
  const sun = new DirectionalLight(scheme.sun as ColorRepresentation, scheme.sunlight)
  sun.position.set(...SUN)
  return [sun, new HemisphereLight(scheme.sky, scheme.grass, scheme.skylight)]
}
