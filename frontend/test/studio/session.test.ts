import { afterEach, expect, test, vi } from 'vitest'
import { Accounts } from '../../src/api/accounts'
import { Client } from '../../src/api/client'
import { Refused } from '../../src/api/request'
import { Store } from '../../src/state'
import { SessionActions } from '../../src/studio/session'
import { StrokeActions } from '../../src/studio/strokeActions'
import { BO, session } from '../accounts'
import { CROWN, model, photoSheets } from '../builders'
import { type Call, problem, service, settle } from '../service'

/** Who has the browser's cookie; null while nobody has one. */
let signedIn: ReturnType<typeof session> | null = null
const nobody = () => problem(401, 'unauthenticated', 'sign in, or send a key')

afterEach(() => {
  signedIn = null
  vi.unstubAllGlobals()
})

function serve({ method, path, body }: Call): Response {
  if (path === '/v1/session' && method === 'POST') {
    if (!body.key.startsWith('ts_')) return problem(401, 'unauthenticated', 'this is no key, or it was mistyped')
    signedIn = session(body.key === 'ts_bo' ? { member: BO } : {})
  }
  if (path === '/v1/session' && method === 'DELETE') {
    signedIn = null
    return new Response(null, { status: 204 })
  }
  if (!signedIn) return nobody()
  return path === '/v1/session' ? Response.json(signedIn) : Response.json(model())
}

function begin(answer = serve) {
  const calls = service(answer)
  const store = new Store()
  const [beginAnew, waits] = [vi.fn(), [] as number[]]
  const wait = async (ms: number) => void waits.push(ms)
  const actions = new SessionActions(store, new Accounts(), beginAnew, wait)
  return { calls, store, actions, beginAnew, waits, client: new Client() }
}

test('where nobody needs to sign in the page knows of no session and asks for none', async () => {
  signedIn = session({ hosted: false })
  const { store, actions } = begin()
  await actions.find()
  expect([store.state.session, store.state.signIn]).toEqual([null, null])
})

test('a request waits until somebody has signed in, and then is answered', async () => {
  const { store, actions, client } = begin()
  await actions.find()
  expect([store.state.session, store.state.signIn]).toEqual([null, 'first'])
  const asked = client.getModel('mdl_1')
  await settle()
  expect(await actions.signIn(' ts_ann ')).toBeNull()
  expect([(await asked).id, store.state.session?.member.name, store.state.signIn]).toEqual(['mdl_1', 'Ann Bauer', null])
})

test('a session that ends brings the sign-in back, with what is drawn as it was', async () => {
  const { store, actions, client, beginAnew } = begin()
  await actions.signIn('ts_ann')
  store.set({ sheets: photoSheets() })
  new StrokeActions(store).draw('crown', CROWN)
  signedIn = null
  const asked = client.getModel('mdl_1')
  await settle()
  expect([store.state.signIn, store.strokes.crown]).toEqual(['again', CROWN])
  await actions.signIn('ts_ann')
  expect([(await asked).id, store.strokes.crown, store.state.signIn]).toEqual(['mdl_1', CROWN, null])
  expect(beginAnew).not.toHaveBeenCalled()
})

test('a request that was sent before somebody signed in is sent again, and nobody is asked', async () => {
  const { store, actions, client } = begin()
  await actions.signIn('ts_ann')
  const [late, now] = [signedIn, store.state.session]
  signedIn = null
  const asked = client.getModel('mdl_1')
  signedIn = late // as another tab does
  expect([(await asked).id, store.state.signIn, store.state.session]).toEqual(['mdl_1', null, now])
})

test('somebody else begins with nothing open', async () => {
  const { actions, beginAnew } = begin()
  await actions.signIn('ts_ann')
  await actions.signOut()
  await actions.signIn('ts_bo')
  expect(beginAnew).toHaveBeenCalledOnce()
})

test('strokes that the browser cannot keep stay open whoever signs in', async () => {
  const { store, actions, beginAnew } = begin()
  await actions.signIn('ts_ann')
  store.set({ kept: false })
  await actions.signIn('ts_bo')
  expect([store.state.session?.member.name, beginAnew.mock.calls]).toEqual(['Bo', []])
})

test('a key that signs nobody in says why, and the page goes on waiting', async () => {
  const { store, actions } = begin()
  await actions.find()
  expect((await actions.signIn('hello'))?.text).toBe('This is no key, or it was mistyped.')
  expect(store.state.signIn).toBe('first')
})

test('signing out closes the page until somebody signs in, also where the session had ended', async () => {
  const { store, actions } = begin()
  await actions.signIn('ts_ann')
  await actions.signOut()
  expect([store.state.session, store.state.signIn]).toEqual([null, 'first'])
})

test('without an answer one stays signed in, and is told so', async () => {
  const { store, actions } = begin(call => (call.method === 'DELETE' ? 'down' : serve(call)) as Response)
  await actions.signIn('ts_ann')
  await actions.signOut()
  expect([store.state.session?.member.name, store.state.notices[0]?.text]).toEqual([
    'Ann Bauer',
    expect.stringContaining('still signed in'),
  ])
})

function limited(retryAfter: string, code = 'rate_limited') {
  let first = true
  return begin(() => {
    if (!first) return Response.json(model())
    first = false
    const refused = problem(429, code, 'calls: ask again later')
    refused.headers.set('Retry-After', retryAfter)
    return refused
  })
}

test('after too many requests the next one waits as long as the service says, and a long wait is told', async () => {
  const { store, client, waits } = limited('12')
  const told: string[] = []
  store.watch(
    state => state.notices,
    notices => told.push(notices.map(({ text }) => text).join()),
  )
  expect((await client.getModel('mdl_1')).id).toBe('mdl_1')
  expect([waits, told]).toEqual([[12_000], ['', expect.stringContaining('by itself in 12 sec'), '']])
})

test('a short wait is not told, and none is longer than a minute', async () => {
  const { store, client, waits } = limited('1')
  await client.getModel('mdl_1')
  expect([waits, store.state.notices]).toEqual([[1000], []])
  await expect(limited('3600').client.getModel('mdl_1')).rejects.toBeInstanceOf(Refused)
  await expect(limited('5', 'queue_full').client.getModel('mdl_1')).rejects.toBeInstanceOf(Refused)
})
