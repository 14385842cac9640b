/** Media types of the videos that the service reads, by file ending. */
export const VIDEO_TYPES: Readonly<Record<string, string>> = {
  mp4: 'video/mp4',
  m4v: 'video/x-m4v',
  mov: 'video/quicktime',
  webm: 'video/webm',
  avi: 'video/x-msvideo',
  gif: 'image/gif',
}

/** Return whether a file is a video; whether it can be read the service decides. */
export function isVideo({ name, type }: Pick<File, 'name' | 'type'>): boolean {
  return isVideoType(type) || name.slice(name.lastIndexOf('.') + 1).toLowerCase() in VIDEO_TYPES
}

/** Return whether a media type is that of a video; a GIF is one. */
export function isVideoType(type: string): boolean {
  return type.startsWith('video/') || type === 'image/gif'
}
