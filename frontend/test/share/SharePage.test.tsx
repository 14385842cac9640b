// @vitest-environment jsdom
import { render } from 'preact'
import { act } from 'preact/test-utils'
import { afterEach, expect, test, vi } from 'vitest'
import { SharePage } from '../../src/share/SharePage'
import { embedCode, linkOf, type SharedModel } from '../../src/share/sharedTree'
import { settle } from '../service'

vi.mock('../../src/share/TreeStage', () => ({ TreeStage: () => null }))

const LINK = 'http://localhost/s/token'
const TREE: SharedModel = {
  ...{ name: 'Oak', bytes: 2_000_000, foliage: 'leaves', form: 'round', height: 9 },
  ...{ photo: false, download: true, expires: '2099-01-01T00:00:00Z' },
}

async function open(answer: () => Response | Promise<Response>, embedded = false): Promise<void> {
  vi.stubGlobal(
    'fetch',
    vi.fn(async () => answer()),
  )
  act(() => render(<SharePage link={LINK} embedded={embedded} />, document.body))
  await act(settle)
}

afterEach(() => {
  render(null, document.body)
  vi.unstubAllGlobals()
})

test('a shared tree is named, offered and embedded as its link says', async () => {
  await open(() => Response.json(TREE))
  expect(document.title).toBe('Oak – treestroke')
  expect(document.querySelector('h1')!.textContent).toBe('Oak')
  expect(document.querySelector('a')!.getAttribute('href')).toBe(`${LINK}/tree.glb`)
  expect(document.querySelector<HTMLInputElement>('.copy-field input')!.value).toBe(embedCode(LINK, 'Oak'))
})

test('without leave there is no download, and in a frame only the way to the page', async () => {
  await open(() => Response.json({ ...TREE, download: false }))
  expect(document.querySelector('a')).toBeNull()
  await open(() => Response.json(TREE), true)
  expect([...document.querySelectorAll('a')].map(({ href }) => href)).toEqual([LINK])
})

test.each([
  [404, 'leads nowhere'],
  [410, 'has ended'],
  [503, 'cannot be loaded'],
])('%i is told in words', async (status, words) => {
  await open(() => new Response('{}', { status }))
  expect(document.querySelector('[role=alert]')!.textContent).toContain(words)
  expect(document.querySelector<HTMLElement>('button')!.hidden).toBe(status !== 503)
})

test('a link has neither query nor slash at its end, and a name cannot leave its quotes', () => {
  expect(linkOf({ origin: 'http://localhost', pathname: '/s/token/' })).toBe(LINK)
  expect(embedCode(LINK, '"><script>')).toContain('title="&quot;>&lt;script>"')
})
