const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10]

/** Tell whether a file is a PNG, by what it begins with: its name may say anything. */
export async function isPng(file: Blob): Promise<boolean> {
  const head = new Uint8Array(await file.slice(0, SIGNATURE.length).arrayBuffer())
  return SIGNATURE.every((byte, at) => head[at] === byte)
}
