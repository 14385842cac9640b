/** Return the address of a clip's video as it was sent. */
export function videoUrl(clip: string): string {
  return `/v1/clips/${clip}/video`
}

/** Return the address of a clip's frame, from 0, as a JPEG; of a height in px, or of its own. */
export function frameUrl(clip: string, frame: number, height?: number): string {
  return `/v1/clips/${clip}/frames/${frame}${height === undefined ? '' : `?height=${height}`}`
}
