import { type GLTF, GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'

/** Where a GLB holds the length of its JSON, and where the JSON begins, bytes. */
const JSON_LENGTH = 12
const JSON_BEGIN = 20

/** Read a GLB; the decoder of compressed ones is loaded only when one is read. */
export async function readGlb(glb: ArrayBuffer): Promise<GLTF> {
  const loader = new GLTFLoader()
  if (isCompressed(glb)) {
    const { MeshoptDecoder } = await import('three/addons/libs/meshopt_decoder.module.js')
    loader.setMeshoptDecoder(MeshoptDecoder)
  }
  return loader.parseAsync(glb, '')
}

/** Return whether a GLB is compressed, as its JSON tells. */
export function isCompressed(glb: ArrayBuffer): boolean {
  if (glb.byteLength < JSON_BEGIN) return false
  const length = new DataView(glb).getUint32(JSON_LENGTH, true)
  const json = new TextDecoder().decode(new Uint8Array(glb, JSON_BEGIN, Math.min(length, glb.byteLength - JSON_BEGIN)))
  return json.includes('_meshopt_compression"')
}
