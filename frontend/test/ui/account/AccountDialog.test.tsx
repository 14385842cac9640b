// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Key, Session } from '../../../src/api/types'
import type { AccountTab } from '../../../src/state'
import { Studio } from '../../../src/studio/studio'
import { AccountDialog } from '../../../src/ui/account/AccountDialog'
import { ANN, BO, key, session } from '../../accounts'
import { type Call, problem, service, settle } from '../../service'
import { withDialogs } from '../dialogs'
import { mount } from '../mount'

const QUOTAS = [
  { name: 'stored_bytes', limit: 20e9, used: 3.14e9 },
  { name: 'queued', limit: 50, used: 12 },
  { name: 'running', limit: null, used: 2 },
]
const LAST_OWNER = problem(409, 'last_owner', 'this is the only owner')
let studio: Studio
let page: HTMLElement
let calls: Call[]
let keys: Key[]

beforeEach(() => {
  withDialogs()
  keys = [key(), key({ id: 'key_2', name: 'Farm', member: BO, scopes: ['trees'], read_only: true })]
  calls = service(serve)
  studio = new Studio()
})
afterEach(() => vi.unstubAllGlobals())

function serve({ method, path, body }: Call): Response {
  if (path === '/v1/limits') return Response.json({ quotas: QUOTAS, rates: [] })
  if (path === '/v1/members') return Response.json(method === 'GET' ? { members: [ANN, BO] } : { ...BO, ...body })
  if (path.startsWith('/v1/members/')) return path.endsWith(ANN.id) ? LAST_OWNER.clone() : Response.json(BO)
  if (method === 'POST') return Response.json({ ...key(body), key: 'ts_whole' })
  if (method === 'DELETE') keys = keys.filter(({ id }) => !path.endsWith(id))
  return method === 'DELETE' ? new Response(null, { status: 204 }) : Response.json({ keys })
}

async function open(tab: AccountTab, who: Partial<Session> = {}): Promise<void> {
  studio.store.set({ session: session(who), dialog: tab })
  page = mount(studio, <AccountDialog />)
  await act(settle)
}

/** Do something, and let the page be drawn. */
async function doing(what: () => void): Promise<void> {
  await act(async () => {
    what()
    await settle()
  })
}

const part = () => page.querySelector<HTMLElement>('[role=tabpanel]:not([hidden])')!
const names = () => [...part().querySelectorAll('.account-row-name')].map(({ textContent }) => textContent!.trim())
const click = (label: string) => doing(() => button(label).click())
const sent = (method: string) => calls.filter(call => call.method === method).map(({ path, body }) => [path, body])

function button(label: string): HTMLElement {
  const all = [...part().querySelectorAll<HTMLElement>('button')]
  return all.find(one => (one.getAttribute('aria-label') ?? one.textContent) === label)!
}

test('one sees one’s own keys, an owner under Team those of all with whose they are', async () => {
  await open('keys')
  expect(names()).toEqual(['Laptop ts_ab12…'])
  await doing(() => studio.store.set({ dialog: 'team' }))
  expect(names()).toEqual(['Ann Bauer you', 'Bo', 'Laptop ts_ab12…', 'Farm ts_ab12…'])
  expect(part().textContent).toContain('Bo · only looks · never used · expires in 90 days')
})

test('a new key is shown this once, to be copied', async () => {
  await open('keys')
  const field = part().querySelector<HTMLInputElement>('form input')!
  await doing(() => {
    field.value = ' My laptop '
    field.dispatchEvent(new Event('input', { bubbles: true }))
  })
  await doing(() => part().querySelector('form')!.requestSubmit())
  const order = { name: 'My laptop', scopes: ['trees', 'team'], read_only: false, days: 90 }
  expect(sent('POST')).toEqual([['/v1/keys', order]])
  const shown = () => part().querySelector<HTMLInputElement>('input[readonly]')?.value
  expect(shown()).toBe('ts_whole')
  await click('Done')
  expect(shown()).toBeUndefined()
})

test('a key is revoked only after a question, whose harmless answer has the focus', async () => {
  await open('keys')
  await click('Revoke Laptop')
  expect([document.activeElement?.textContent, sent('DELETE')]).toEqual(['Keep it', []])
  await click('Keep it')
  await click('Revoke Laptop')
  await click('Revoke')
  expect([sent('DELETE'), names()]).toEqual([[['/v1/keys/key_1', undefined]], []])
})

test('the only owner stays one: it is said why, and the role is as it was', async () => {
  await open('team')
  const select = part().querySelector<HTMLSelectElement>('.account-row select')!
  await doing(() => {
    select.value = 'viewer'
    select.dispatchEvent(new Event('change', { bubbles: true }))
  })
  expect([select.value, page.querySelector('.account-fault')!.textContent]).toEqual([
    'owner',
    expect.stringContaining('A team needs an owner.'),
  ])
})

test('with a key that only reads nothing is offered that changes anything', async () => {
  await open('keys', { read_only: true })
  const labels = [...page.querySelectorAll('[role=tab]')].map(({ textContent }) => textContent)
  expect([labels, part().querySelector('form, button')]).toEqual([['Your keys', 'Activity', 'Limits'], null])
  expect(part().textContent).toContain('a key that only reads')
})

test('quotas are bars with words; what has no limit has no bar', async () => {
  await open('limits', { member: BO })
  const said = [...part().querySelectorAll('.quota-said')].map(({ textContent }) => textContent)
  expect(said).toEqual(['3.1 GB of 20 GB stored', '12 of 50 waiting', '2 growing, no limit'])
  const bars = [...part().querySelectorAll<HTMLElement>('[role=meter]')]
  expect(bars.map(bar => bar.hidden)).toEqual([false, false, true])
})
