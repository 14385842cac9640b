import { type GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'

const JSON_LENGTH = 12
const JSON_BEGIN = 20

/** Read a GLB; what unpacks compressed ones is only brought where one is. */
export async function readGlb(glb: ArrayBuffer): Promise<GLTF> {
  const loader = new GLTFLoader()
  if (isCompressed(glb)) {
    const { MeshoptDecoder } = await import('three/addons/libs/meshopt_decoder.module.js')
    loader.setMeshoptDecoder(MeshoptDecoder)
  }
  return loader.parseAsync(glb, '')
}

/** Tell whether a GLB is compressed, by the head of the file. */
export function isCompressed(glb: ArrayBuffer): boolean {
  if (glb.byteLength < JSON_BEGIN) return false
  const length = new DataView(glb).getUint32(JSON_LENGTH, true)
  const json = new TextDecoder().decode(new Uint8Array(glb, JSON_BEGIN, Math.min(length, glb.byteLength - JSON_BEGIN)))
  return json.includes('_meshopt_compression"')
}
