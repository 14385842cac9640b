import { readdirSync, readFileSync } from 'node:fs'
import { dirname, join, normalize } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, test } from 'vitest'

const SOURCES = fileURLToPath(new URL('../src', import.meta.url))
/** Each layer may import itself and those after it, but no other of its own row. */
const LAYERS = [
  ['main'],
  ['ui'],
  ['sketch', 'preview', 'studio'],
  ['api', 'text', 'tracedBranch', 'doubts'],
  ['sheets'],
  ['state'],
  ['plane'],
  ['history', 'strokes'],
  ['api/defaults'],
  ['api/schema'],
]

function layerOf(path: string): string {
  const whole = path.replace(/\.(ts|css|d\.ts)$/, '')
  return LAYERS.flat().includes(whole) ? whole : path.split(/[/.]/)[0]!
}

function imports(): [from: string, to: string][] {
  const files = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' }).filter(name => /(?<!\.d)\.ts$/.test(name))
  return files.flatMap(file => {
    const named = readFileSync(join(SOURCES, file), 'utf8').matchAll(
      /(?:from|import) '(\.[^']+)'|import\('(\.[^']+)'\)/g,
    )
    return [...named].map(([, plain, late]): [string, string] => [
      file,
      normalize(join(dirname(file), (plain ?? late)!)),
    ])
  })
}

const row = (layer: string) => LAYERS.findIndex(layers => layers.includes(layer))

test('every file imports its own layer and lower ones only', () => {
  const upward = imports().filter(([from, to]) => {
    const [above, below] = [layerOf(from), layerOf(to)]
    return above !== below && !(row(above) < row(below))
  })
  expect(upward).toEqual([])
})

test('every file has its layer', () => {
  expect(
    imports()
      .flat()
      .filter(path => row(layerOf(path)) < 0),
  ).toEqual([])
})
