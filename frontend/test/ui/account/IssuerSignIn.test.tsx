// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import { Studio } from '../../../src/studio/studio'
import { IssuerSignIn } from '../../../src/ui/account/IssuerSignIn'
import { problem, service, settle } from '../../service'
import { mount } from '../mount'

const MODEL = `mdl_${'0'.repeat(24)}`

beforeEach(() => history.replaceState(null, '', '/'))
afterEach(() => vi.unstubAllGlobals())

async function shown(oidc: { name: string } | null, isAgain = false): Promise<HTMLElement> {
  service(({ path }) => (path === '/v1/sign-in' ? Response.json({ oidc }) : problem(401, 'unauthenticated', 'sign in')))
  const page = mount(new Studio(), <IssuerSignIn isAgain={isAgain} />)
  await act(settle)
  return page
}

test('the issuer is named where there is one, and the model of the address is kept', async () => {
  history.replaceState(null, '', `/#${MODEL}`)
  const link = (await shown({ name: 'id.example' })).querySelector('a')!
  expect([link.textContent, link.getAttribute('href'), link.target]).toEqual([
    'Sign in with id.example',
    `/v1/session/oidc?model=${MODEL}`,
    '',
  ])
})

test('without an issuer nothing is shown', async () => {
  expect((await shown(null)).textContent).toBe('')
})

test('where something is drawn it stays open', async () => {
  const page = await shown({ name: 'id.example' }, true)
  expect(page.querySelector('a')!.target).toBe('_blank')
  expect(page.textContent).toContain('another tab')
})

test('what went wrong is said once', async () => {
  history.replaceState(null, '', '/?sign-in=not_member')
  expect((await shown({ name: 'id.example' })).querySelector('[role=alert]')!.textContent).toContain('in no team')
  expect(location.search).toBe('')
  expect((await shown({ name: 'id.example' })).querySelector('[role=alert]')).toBeNull()
})

test('a code that nobody knows is a failure, too', async () => {
  history.replaceState(null, '', '/?sign-in=<b>')
  expect((await shown({ name: 'id.example' })).querySelector('[role=alert]')!.textContent).toContain('not signed in')
})
