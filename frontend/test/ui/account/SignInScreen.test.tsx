// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { SignIn } from '../../../src/ui/account/Account'
import { session } from '../../accounts'
import { type Call, problem, service, settle } from '../../service'
import { withDialogs } from '../dialogs'
import { mount } from '../mount'

let studio: Studio
let page: HTMLElement
let isIn = false

beforeEach(async () => {
  withDialogs()
  isIn = false
  service(serve)
  studio = new Studio()
  page = mount(studio, <SignIn />)
  await act(() => studio.session.find())
  await vi.waitFor(() => expect(dialog()).not.toBeNull(), { timeout: 30_000 }) // it is loaded
}, 40_000)
afterEach(() => vi.unstubAllGlobals())

function serve({ method, body }: Call): Response {
  if (method === 'POST' && body.key === 'ts_old') return problem(401, 'unauthenticated', 'this key is unknown')
  if (method === 'POST') isIn = true
  return isIn ? Response.json(session()) : problem(401, 'unauthenticated', 'sign in')
}

const dialog = () => page.querySelector<HTMLDialogElement>('dialog')
const field = () => page.querySelector('input')!

async function sign(key: string): Promise<void> {
  field().value = key
  await act(async () => {
    page.querySelector('form')!.requestSubmit()
    await settle()
  })
}

test('the screen stays until somebody has signed in, and Escape does not close it', async () => {
  expect([dialog()!.open, document.activeElement]).toEqual([true, field()])
  expect(dialog()!.dispatchEvent(new Event('cancel', { cancelable: true }))).toBe(false)
  dialog()!.close()
  expect(dialog()!.open).toBe(true)
  await sign('ts_good')
  expect([dialog(), studio.store.state.session?.member.name]).toEqual([null, 'Ann Bauer'])
})

test('a key that is refused says why beside the field, and one that is missing too', async () => {
  await sign('ts_old')
  const said = () => document.getElementById(field().getAttribute('aria-describedby')!)!.textContent
  expect([said(), field().getAttribute('aria-invalid')]).toEqual(['This key is unknown.', 'true'])
  await sign(' ')
  expect(said()).toBe('Paste your key first.')
})

test('where a session has ended it says that the drawing is as it was', async () => {
  await sign('ts_good')
  isIn = false
  await act(async () => {
    void studio.client.getLimits()
    await settle()
  })
  expect(dialog()!.textContent).toContain('your drawing is as you left it')
})
