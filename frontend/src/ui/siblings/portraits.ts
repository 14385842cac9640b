import { Portraits } from '../../preview/portraits'

/** How many pictures are kept; those of models that were left go first. */
const KEPT = 64

let portraits: Portraits | null = null
const addresses = new Map<string, Promise<string>>()

/** Return the address of a picture of a tree, drawn once for each address of a GLB. */
export function portraitOf(url: string, fetch: (url: string) => Promise<ArrayBuffer>): Promise<string> {
  const known = addresses.get(url)
  if (known) return known
  portraits ??= new Portraits(matchMedia('(prefers-color-scheme: dark)').matches)
  const drawer = portraits
  const made = fetch(url).then(async glb => URL.createObjectURL(await drawer.of(glb)))
  addresses.set(url, made)
  made.catch(() => addresses.delete(url))
  forgetOldest()
  return made
}

function forgetOldest(): void {
  const [oldest] = addresses
  if (addresses.size <= KEPT || !oldest) return
  addresses.delete(oldest[0])
  void oldest[1].then(address => URL.revokeObjectURL(address))
}
