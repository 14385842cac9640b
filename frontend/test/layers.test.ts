import { readdirSync, readFileSync } from 'node:fs'
import { dirname, join, normalize } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, test } from 'vitest'

const SOURCES = fileURLToPath(new URL('../src', import.meta.url))
/** Each layer may import itself and those after it, but no other of its own row. */
const LAYERS = [
  ['main', 'share'],
  ['ui'],
  ['sketch', 'preview', 'studio'],
  ['api', 'text', 'tracedBranch', 'tracedOn', 'doubts', 'taken', 'access'],
  ['sheets'],
  ['state'],
  ['plane', 'cameras', 'branches', 'outlineOf'],
  ['history', 'strokes'],
  ['edits', 'playhead'],
  ['api/defaults', 'api/types', 'api/addresses'],
  ['api/schema'],
]

function layerOf(path: string): string {
  const whole = path.replace(/\.(tsx?|css|d\.ts)$/, '')
  return LAYERS.flat().includes(whole) ? whole : path.split(/[/.]/)[0]!
}

const FILES = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' }).filter(name => /(?<!\.d)\.tsx?$/.test(name))

function importsLike(pattern: RegExp): [from: string, to: string][] {
  return FILES.flatMap(file => {
    const code = readFileSync(join(SOURCES, file), 'utf8')
    return [...code.matchAll(pattern)].map(([, to]): [string, string] => [file, to!])
  })
}

/** Imports of the page's own files, by their paths from `src`. */
const OWN = importsLike(/(?:from |import |import\()'(\.[^']+)'/g).map(([from, to]): [from: string, to: string] => [
  from,
  normalize(join(dirname(from), to)),
])
const PACKAGES = importsLike(/from '([^.'][^']*)'/g)

const row = (layer: string) => LAYERS.findIndex(layers => layers.includes(layer))

test('every file imports its own layer and lower ones only', () => {
  const upward = OWN.filter(([from, to]) => {
    const [above, below] = [layerOf(from), layerOf(to)]
    return above !== below && !(row(above) < row(below))
  })
  expect(upward).toEqual([])
})

test('every file has its layer', () => {
  expect(OWN.flat().filter(path => row(layerOf(path)) < 0)).toEqual([])
})

test('no file imports itself by way of others', () => {
  const imported = new Map(FILES.map(file => [file.replace(/\.tsx?$/, ''), [] as string[]]))
  for (const [from, to] of OWN) if (imported.has(to)) imported.get(from.replace(/\.tsx?$/, ''))!.push(to)
  const done = new Set<string>()
  const circleFrom = (file: string, way: readonly string[]): readonly string[] => {
    if (way.includes(file)) return [...way.slice(way.indexOf(file)), file]
    if (done.has(file)) return []
    for (const next of imported.get(file)!) {
      const circle = circleFrom(next, [...way, file])
      if (circle.length) return circle
    }
    done.add(file)
    return []
  }
  expect([...imported.keys()].flatMap(file => circleFrom(file, []))).toEqual([])
})

test('only panels use Preact, and the preview knows nothing of the page’s state', () => {
  const users = PACKAGES.filter(([, to]) => /^preact\b/.test(to)).map(([from]) => layerOf(from))
  expect([...new Set(users)].filter(layer => !['main', 'share', 'ui'].includes(layer))).toEqual([])
  const seen = OWN.filter(([from]) => from.startsWith('preview/')).map(([, to]) => layerOf(to))
  expect([...new Set(seen)].toSorted()).toEqual(['api/types', 'branches', 'playhead', 'preview'])
})
