const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10]

/** Return whether a file is a PNG, by its first bytes, since its name may be wrong. */
export async function isPng(file: Blob): Promise<boolean> {
  const head = new Uint8Array(await file.slice(0, SIGNATURE.length).arrayBuffer())
  return SIGNATURE.every((byte, at) => head[at] === byte)
}
