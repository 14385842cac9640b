// @vitest-environment jsdom
import 'fake-indexeddb/auto'
import { act } from 'preact/test-utils'
import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Session, Share } from '../../../src/api/types'
import { Studio } from '../../../src/studio/studio'
import { SharePanel, sharedId } from '../../../src/ui/tree/SharePanel'
import { shownModel } from '../../builders'
import { type Call, service, settle } from '../../service'
import { mount } from '../mount'

let studio: Studio
let calls: Call[]
let shares: Share[]
let panel: HTMLElement

const session = (role: Session['member']['role']): Session => ({
  hosted: true,
  member: { id: 'usr_1', name: 'Ann', role },
  team: { id: 'team_1', name: 'Oaks' },
  scopes: ['trees', 'team'],
  read_only: false,
  expires: null,
})

const share = (changes: Partial<Share> = {}): Share => ({
  ...{ id: 'shr_1', url: null, created: '2026-05-01T00:00:00Z', expires: '2099-06-01T00:00:00Z' },
  ...{ revoked: null, photo: false, download: true, ...changes },
})

async function open(role: Session['member']['role']): Promise<void> {
  studio = new Studio()
  studio.store.set({ model: shownModel({ status: 'succeeded' }), session: session(role) })
  panel = mount(studio, <SharePanel />)
  await act(settle)
}

async function press(words: string): Promise<void> {
  const found = [...panel.querySelectorAll('button')].find(({ textContent }) => textContent === words)!
  await act(async () => {
    found.click()
    await settle()
  })
}

beforeEach(() => {
  shares = []
  calls = service(({ method }) => {
    if (method === 'POST') {
      shares = [share()]
      return Response.json({ ...share(), url: 'http://localhost/s/token' })
    }
    if (method === 'DELETE') {
      shares = shares.map(one => ({ ...one, revoked: '2026-05-02T00:00:00Z' }))
      return new Response(null, { status: 204 })
    }
    return Response.json({ shares })
  })
})
afterEach(() => vi.unstubAllGlobals())

test('a link is made as it was chosen, shown once, and revoked', async () => {
  await open('member')
  expect(panel.textContent).toContain('There are no links')
  await act(() => panel.querySelectorAll<HTMLInputElement>('input[type=checkbox]')[0]!.click())
  await press('Make link')
  expect(calls.find(({ method }) => method === 'POST')!.body).toEqual({ days: 30, photo: true, download: true })
  expect(panel.querySelector<HTMLInputElement>('.copy-field input')!.value).toBe('http://localhost/s/token')
  await press('Revoke')
  expect(calls.at(-2)).toMatchObject({ method: 'DELETE', path: '/v1/shares/shr_1' })
  expect(panel.querySelector('.copy-field')).toBeNull()
  expect(panel.querySelector('.share-line.is-over')!.textContent).toContain('revoked on')
})

test('a viewer sees the links but neither makes nor revokes any', async () => {
  shares = [share({ photo: true, download: false })]
  await open('viewer')
  expect(panel.querySelector('.share-line')!.textContent).toMatch(/works until .*with the photo, without download/)
  expect(panel.querySelectorAll('.shares button')).toHaveLength(0)
})

test('there are links only to finished trees, and only where one signs in', async () => {
  await open('owner')
  const { state } = studio.store
  expect(sharedId(state)).toBe('mdl_1')
  expect(sharedId({ ...state, session: null })).toBeNull()
  expect(sharedId({ ...state, model: shownModel({ status: 'running' }) })).toBeNull()
})
