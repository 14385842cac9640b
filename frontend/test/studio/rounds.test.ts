import { expect, test } from 'vitest'
import { Rounds } from '../../src/studio/rounds'

/** Rounds whose runs wait until they are released, one after another. */
function held(fails = (_: number) => false) {
  const begun: (() => void)[] = []
  const rounds = new Rounds(async () => {
    const number = begun.length
    await new Promise<void>(done => begun.push(done))
    if (fails(number)) throw new Error('broken')
  })
  return { begun, rounds }
}

const settled = () => new Promise(done => setTimeout(done))

test('there is one run at a time, and all requests meanwhile lead to one more', async () => {
  const { begun, rounds } = held()
  const first = rounds.ask()
  rounds.ask()
  rounds.ask()
  expect(begun).toHaveLength(1)
  begun[0]!()
  await settled()
  expect(begun).toHaveLength(2)
  begun[1]!()
  await first
  expect(begun).toHaveLength(2)
})

test('a run that fails rejects, and the next one can be requested', async () => {
  const { begun, rounds } = held(number => number === 0)
  const first = rounds.ask()
  begun[0]!()
  await expect(first).rejects.toThrow('broken')
  const second = rounds.ask()
  begun[1]!()
  await expect(second).resolves.toBeUndefined()
})
