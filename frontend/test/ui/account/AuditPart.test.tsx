// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { AuditEntry } from '../../../src/api/types'
import { Studio } from '../../../src/studio/studio'
import { AuditPart } from '../../../src/ui/account/AuditPart'
import { ANN } from '../../accounts'
import { type Call, problem, service, settle } from '../../service'
import { mount } from '../mount'

const NOON = Date.UTC(2026, 10, 30, 12) / 1000
const DAY_S = 86_400
let page: HTMLElement
let calls: Call[]

function entry(id: number, action: string, changes: Partial<AuditEntry> = {}): AuditEntry {
  const by = { who: { id: ANN.id, name: ANN.name }, credential: 'key_1', address: '10.0.0.1', request_id: 'r' }
  return { id: String(id), at: NOON, action, subject: 'x', details: {}, ...by, ...changes }
}

async function open(answer: (call: Call) => Response): Promise<void> {
  calls = service(answer)
  page = mount(new Studio(), <AuditPart />)
  await act(settle)
}

const texts = (selector: string) => [...page.querySelectorAll(selector)].map(({ textContent }) => textContent)

beforeEach(() => vi.unstubAllGlobals())
afterEach(() => vi.unstubAllGlobals())

test('what was done is told by day, and older entries are asked for', async () => {
  const pages = [
    { entries: [entry(3, 'key.made', { details: { name: 'Laptop' } })], next: '3' },
    { entries: [entry(2, 'member.added', { at: NOON - DAY_S, details: { name: 'Bo', role: 'member' } })], next: null },
  ]
  await open(({ path }) => Response.json(pages[path.includes('before=3') ? 1 : 0]))
  expect(texts('li p')).toEqual(['Ann Bauer made the key “Laptop”'])
  await act(async () => {
    page.querySelector('button')!.click()
    await settle()
  })
  expect(texts('li p')).toEqual(['Ann Bauer made the key “Laptop”', 'Ann Bauer added Bo as member'])
  expect(texts('h3')).toHaveLength(2)
  expect(page.querySelector('button')!.hidden).toBe(true)
  expect(calls).toHaveLength(2)
})

test('who is no member is named by how they came', async () => {
  const nobody = { who: null }
  const entries = [
    entry(3, 'key.made', { ...nobody, credential: 'command line', details: { name: 'first' } }),
    entry(2, 'sign_in.refused', { ...nobody, details: { name: 'old' } }),
    entry(1, 'something.new'),
  ]
  await open(() => Response.json({ entries, next: null }))
  expect(texts('li p')).toEqual([
    'The operator of this service made the key “first”',
    'Somebody tried to sign in by the key “old”, which has ended',
    'Ann Bauer something.new',
  ])
})

test('an audit that cannot be read shows nothing of it', async () => {
  await open(() => problem(403, 'role_missing', 'this takes the role owner').clone())
  expect(page.textContent).toBe('')
})
