import type { Viewport } from './camera'

/** What kind of WebGL there is; `software` draws on the processor. */
export type WebglKind = 'ok' | 'software' | 'absent'

const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render|\bwarp\b/i

/** Whether a renderer of this name draws on the processor. */
export function isSoftware(renderer: string): boolean {
  return SOFTWARE.test(renderer)
}

/** Ask a canvas of its own, and let it go again. */
export function probeWebgl(): WebglKind {
  const gl = document.createElement('canvas').getContext('webgl2')
  if (!gl) return 'absent'
  const named = gl.getExtension('WEBGL_debug_renderer_info')
  const renderer = String(gl.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : gl.RENDERER))
  gl.getExtension('WEBGL_lose_context')?.loseContext()
  return isSoftware(renderer) ? 'software' : 'ok'
}

/** Pixels for each CSS pixel that a processor draws in time: fewer on a large canvas, fewer still while something moves. */
export function thriftyRatio({ width, height }: Viewport, moving: boolean): number {
  const [budget, least, most] = moving ? [140e3, 0.3, 0.6] : [700e3, 0.5, 0.75]
  return Math.min(Math.max(Math.sqrt(budget / (width * height)), least), most)
}
