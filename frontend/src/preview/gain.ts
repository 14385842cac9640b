import { Quaternion, Vector3 } from 'three'

/** The largest turn from the mean, radians: beyond it a branch would lie on itself. */
const LARGEST = 2.5

/** Return the mean of rotations (x, y, z, w each); opposite quaternions are the same rotation. */
export function meanTurn(turns: ArrayLike<number>): Quaternion {
  const sum = [0, 0, 0, 0]
  for (let at = 0; at < turns.length; at += 4) {
    const dot = sum[0]! * turns[at]! + sum[1]! * turns[at + 1]! + sum[2]! * turns[at + 2]! + sum[3]! * turns[at + 3]!
    for (let part = 0; part < 4; part++) sum[part]! += dot < 0 ? -turns[at + part]! : turns[at + part]!
  }
  return new Quaternion(...(sum as [number, number, number, number])).normalize()
}

/** Write rotations (x, y, z, w each) into `to`, each turned from the mean by `gain` times its angle: 0 is calm, 1 as they are. */
export function magnify(turns: ArrayLike<number>, mean: Quaternion, gain: number, to: Float32Array): void {
  const back = mean.clone().invert()
  const [turn, axis] = [new Quaternion(), new Vector3()]
  for (let at = 0; at < turns.length; at += 4) {
    turn.fromArray(turns as number[], at).premultiply(back)
    if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w)
    axis.set(turn.x, turn.y, turn.z)
    const angle = 2 * Math.atan2(axis.length(), turn.w)
    turn.setFromAxisAngle(axis.normalize(), Math.min(angle * gain, LARGEST))
    turn.premultiply(mean).toArray(to, at)
  }
}
