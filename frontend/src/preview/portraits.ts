import { Box3, NeutralToneMapping, OrthographicCamera, Scene, Vector3, WebGLRenderer } from 'three'
import { lightsOf, stillUniforms } from './grove/lit'
import { modelContent } from './model'

/** The size of a portrait, px. */
export const PORTRAIT = { width: 240, height: 288 } as const
/** Room around the tree, as a factor of its size. */
const ROOM = 1.06

/** Draws pictures of trees from the front on a transparent ground, one after the other, on a canvas of its own. */
export class Portraits {
  private readonly canvas = new OffscreenCanvas(PORTRAIT.width, PORTRAIT.height)
  private readonly renderer = new WebGLRenderer({
    canvas: this.canvas as unknown as HTMLCanvasElement,
    alpha: true,
    antialias: true,
    preserveDrawingBuffer: true,
  })
  private last: Promise<unknown> = Promise.resolve()

  constructor(private readonly dark: boolean) {
    this.renderer.toneMapping = NeutralToneMapping
    this.renderer.setSize(PORTRAIT.width, PORTRAIT.height, false)
  }

  /** Return a picture of a tree, given its GLB, as a PNG. */
  of(glb: ArrayBuffer): Promise<Blob> {
    const drawn = this.last.then(() => this.draw(glb))
    this.last = drawn.catch(() => {})
    return drawn
  }

  /** Free what is held on the GPU. */
  end(): void {
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }

  private async draw(glb: ArrayBuffer): Promise<Blob> {
    const content = await modelContent(glb, stillUniforms(), true)
    const scene = new Scene().add(content.group, ...lightsOf(this.dark))
    const { min, max } = content.box
    this.renderer.render(scene, cameraOn(new Box3(new Vector3(...min), new Vector3(...max))))
    content.dispose()
    return this.canvas.convertToBlob({ type: 'image/png' })
  }
}

/** Return a camera that sees all of a box from the front. */
function cameraOn(box: Box3): OrthographicCamera {
  const [size, middle] = [box.getSize(new Vector3()), box.getCenter(new Vector3())]
  const high = (ROOM * Math.max(size.y, (size.x * PORTRAIT.height) / PORTRAIT.width)) / 2
  const wide = (high * PORTRAIT.width) / PORTRAIT.height
  const camera = new OrthographicCamera(-wide, wide, high, -high, 0.01, 2 * size.z + 10)
  camera.position.set(middle.x, middle.y, box.max.z + size.z / 2 + 1)
  return camera
}
