import { expect, test } from 'vitest'
import { droppedIn } from '../../../src/ui/parts/dropped'

const file = (name: string) => ({ isFile: true, name, file: (take: (file: File) => void) => take(new File([], name)) })

/** A folder whose entries come two at a time, as a browser's come by the hundred. */
function folder(name: string, entries: readonly object[]) {
  const waiting = [...entries]
  const readEntries = (take: (some: object[]) => void) => take(waiting.splice(0, 2))
  return { isFile: false, isDirectory: true, name, createReader: () => ({ readEntries }) }
}

function dropped(entries: readonly object[], files: readonly File[] = []) {
  const items = entries.map(entry => ({ webkitGetAsEntry: () => entry }))
  return droppedIn({ items, files } as unknown as DataTransfer)
}

const names = (files: readonly File[]) => files.map(({ name }) => name)

test('files are taken as they are', async () => {
  const found = await dropped([file('a.jpg')], [new File([], 'a.jpg')])
  expect(names(found.files)).toEqual(['a.jpg'])
  expect(found.folder).toBe('')
})

test('all files of a folder are taken, without those of its folders, and it gives the name', async () => {
  const oak = folder('Oak', [file('1.jpg'), file('2.jpg'), file('3.jpg'), folder('small', [file('1s.jpg')])])
  const found = await dropped([oak], [new File([], 'Oak')])
  expect(names(found.files)).toEqual(['1.jpg', '2.jpg', '3.jpg'])
  expect(found.folder).toBe('Oak')
})

test('a folder beside files gives no name', async () => {
  const found = await dropped([folder('Oak', [file('1.jpg')]), file('2.jpg')])
  expect(names(found.files)).toEqual(['1.jpg', '2.jpg'])
  expect(found.folder).toBe('')
})
