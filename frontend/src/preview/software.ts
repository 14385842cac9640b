import type { Viewport } from './camera'

/** Whether there is WebGL, and whether the processor draws it (`software`). */
export type WebglKind = 'ok' | 'software' | 'absent'

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render|\bwarp\b/i

/** Return whether the renderer of this name draws on the processor. */
export function isSoftware(renderer: string): boolean {
  return SOFTWARE.test(renderer)
}

/** Find out on a temporary canvas what WebGL there is. */
export function probeWebgl(): WebglKind {
  const gl = document.createElement('canvas').getContext('webgl2')
  if (!gl) return 'absent'
  const debugInfo = gl.getExtension('WEBGL_debug_renderer_info')
  const renderer = String(gl.getParameter(debugInfo ? debugInfo.UNMASKED_RENDERER_WEBGL : gl.RENDERER))
  gl.getExtension('WEBGL_lose_context')?.loseContext()
  return isSoftware(renderer) ? 'software' : 'ok'
}

/** Return how many pixels per CSS px a processor draws in time: fewer on a large canvas, and while something moves. */
export function softwarePixelRatio({ width, height }: Viewport, moving: boolean): number {
  const [budget, least, most] = moving ? [140e3, 0.3, 0.6] : [700e3, 0.5, 0.75]
  return Math.min(Math.max(Math.sqrt(budget / (width * height)), least), most)
}
