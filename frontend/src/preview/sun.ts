import type { Vec3 } from './camera'

const TO_SUN: Vec3 = [-0.52, 0.82, 0.46]
const length = Math.hypot(...TO_SUN)

/** The unit vector towards the sun, which stands high, on the left behind the photo's camera. */
export const SUN: Vec3 = [TO_SUN[0] / length, TO_SUN[1] / length, TO_SUN[2] / length]
