/** Files that were dropped together, and the name of the folder where they were dropped as one. */
export interface Dropped {
  readonly files: readonly File[]
  readonly folder: string
}

/** Return what is dropped: files, and those in folders. What the browser gives is gone once the event is over. */
export function droppedIn({ items, files }: DataTransfer): Promise<Dropped> {
  const entries = [...items].flatMap(item => item.webkitGetAsEntry?.() ?? [])
  const folders = entries.filter(entry => entry.isDirectory)
  const loose = [...files] // a folder is among them, too, as a file that cannot be read
  if (!folders.length) return Promise.resolve({ files: loose, folder: '' })
  return Promise.all(entries.map(filesIn)).then(found => ({
    files: found.flat(),
    folder: entries.length === 1 ? entries[0]!.name : '',
  }))
}

/** Return the files of an entry; a folder's own folders are left out: they are other trees, or copies. */
async function filesIn(entry: FileSystemEntry): Promise<File[]> {
  if (isFile(entry)) return [await fileOf(entry)]
  const files = (await entriesIn(entry as FileSystemDirectoryEntry)).filter(isFile)
  return Promise.all(files.map(fileOf))
}

function isFile(entry: FileSystemEntry): entry is FileSystemFileEntry {
  return entry.isFile
}

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => entry.file(resolve, reject))
}

/** Return all entries of a folder; the browser gives some 100 at a time, and none at the end. */
async function entriesIn(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader()
  const next = () => new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject))
  const all: FileSystemEntry[] = []
  for (let some = await next(); some.length; some = await next()) all.push(...some)
  return all
}
