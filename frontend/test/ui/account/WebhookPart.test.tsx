// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Delivery, Webhook } from '../../../src/api/types'
import { Studio } from '../../../src/studio/studio'
import { WebhookPart } from '../../../src/ui/account/WebhookPart'
import { session } from '../../accounts'
import { type Call, problem, service, settle } from '../../service'
import { mount } from '../mount'

const URL = `https:${'//'}studio.example/hooks`
const DELIVERY: Delivery = {
  id: 'msg_1',
  event: 'model.succeeded',
  state: 'waiting',
  attempts: 1,
  status: 500,
  error: null,
  seconds: 0.24,
  created: '2026-05-04T09:33:00Z',
  last_attempt: new Date().toISOString(),
  next_attempt: '2026-05-04T09:38:00Z',
}
const WEBHOOK: Webhook = {
  id: 'hook_1',
  url: URL,
  events: ['model.succeeded'],
  enabled: true,
  disabled_reason: null,
  created: '2026-05-04T09:33:00Z',
  last_delivery: null,
}
let studio: Studio
let page: HTMLElement
let calls: Call[]
let webhooks: Webhook[]
let answerToMaking: () => Response

beforeEach(() => {
  webhooks = [WEBHOOK]
  answerToMaking = () => Response.json({ ...WEBHOOK, id: 'hook_2', secret: 'whsec_new' }, { status: 201 })
  calls = service(({ method, path }) => {
    if (path.endsWith('/deliveries')) return Response.json({ deliveries: [DELIVERY], next: null })
    if (method === 'GET') return Response.json({ webhooks })
    if (method === 'PATCH') return Response.json({ ...WEBHOOK, secret: null })
    if (method === 'DELETE') return new Response(null, { status: 204 })
    return path === '/v1/webhooks' ? answerToMaking() : Response.json(DELIVERY, { status: 202 })
  })
  studio = new Studio()
  studio.store.set({ session: session() })
})

afterEach(() => vi.unstubAllGlobals())

async function open(): Promise<void> {
  page = mount(studio, <WebhookPart />)
  await act(settle)
}

async function doing(what: () => void): Promise<void> {
  await act(async () => {
    what()
    await settle()
  })
}

const facts = () => page.querySelector('.account-facts')!.textContent
const sent = (method: string) => calls.filter(call => call.method === method).map(({ path, body }) => [path, body])

function click(label: string): Promise<void> {
  const all = [...page.querySelectorAll<HTMLElement>('button')]
  return doing(() => all.find(one => (one.getAttribute('aria-label') ?? one.textContent) === label)!.click())
}

async function add(url: string): Promise<void> {
  const field = page.querySelector<HTMLInputElement>('input[type=url]')!
  await doing(() => {
    field.value = url
    field.dispatchEvent(new Event('input', { bubbles: true }))
  })
  await doing(() => page.querySelector('form')!.requestSubmit())
}

test('what was sent last and whether the service has disabled it is told', async () => {
  await open()
  expect(facts()).toBe('on · nothing sent yet')
  webhooks = [{ ...WEBHOOK, last_delivery: { ...DELIVERY, event: 'ping', state: 'delivered', status: 204 } }]
  await open()
  expect(facts()).toBe('on · Test · taken · answered 204 in 0.2 s · just now')
  webhooks = [{ ...WEBHOOK, enabled: false, disabled_reason: 'gone' }]
  await open()
  expect(facts()).toContain('off: its receiver answered that it is gone')
})

test('a new webhook is told of what is chosen, and its secret is shown this once', async () => {
  await open()
  await doing(() => page.querySelectorAll<HTMLInputElement>('input[type=checkbox]')[1]!.click())
  await doing(() => page.querySelectorAll<HTMLInputElement>('input[type=checkbox]')[3]!.click())
  await add(` ${URL} `)
  expect(sent('POST')).toEqual([['/v1/webhooks', { url: URL, events: ['model.succeeded', 'capture.solved'] }]])
  const shown = () => page.querySelector<HTMLInputElement>('input[readonly]')?.value
  expect(shown()).toBe('whsec_new')
  await click('Done')
  expect(shown()).toBeUndefined()
})

test('an address that is not public is refused with the reason, and stays in the field', async () => {
  answerToMaking = () => problem(422, 'webhook_address', 'url: the host has the address 10.0.0.1, which is not public')
  await open()
  await add(URL)
  expect(studio.store.state.faults.account?.text).toBe('The host has the address 10.0.0.1, which is not public.')
  expect(page.querySelector<HTMLInputElement>('input[type=url]')!.value).toBe(URL)
})

test('a test message, the log, and sending again', async () => {
  await open()
  await click(`Send a test to ${URL}`)
  await click(`Log of ${URL}`)
  await act(settle)
  expect(page.querySelector('.webhook-log')!.textContent).toMatch(/A tree is finished.*answered 500.*again May 4, 2026/)
  await click('Send A tree is finished again')
  expect(sent('POST').map(([path]) => path)).toEqual(['/v1/webhooks/hook_1/ping', '/v1/deliveries/msg_1/resend'])
})

test('a webhook is turned off at once, and removed or given another secret after a question', async () => {
  await open()
  await click(`Turn off ${URL}`)
  expect(sent('PATCH')).toEqual([['/v1/webhooks/hook_1', { enabled: false }]])
  await click(`Remove ${URL}`)
  expect([document.activeElement?.textContent, sent('DELETE')]).toEqual(['Keep', []])
  webhooks = []
  await click('Remove')
  expect(sent('DELETE')).toEqual([['/v1/webhooks/hook_1', undefined]])
  expect(page.textContent).toContain('There is no webhook yet.')
})
