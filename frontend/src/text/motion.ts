import { whole } from './numbers'

const tenths = new Intl.NumberFormat('en', { minimumFractionDigits: 1, maximumFractionDigits: 1 })
const factors = new Intl.NumberFormat('en', { maximumFractionDigits: 2 })

/** Texts about how a tree moves, and how that is played. */
export const motionText = {
  group: 'Motion',
  names: { still: 'Still', measured: 'Measured', breeze: 'Breeze', gust: 'Gust' } as Readonly<Record<string, string>>,
  add: 'Add wind',
  addHow: 'No wind yet. Choose it in Settings, File, then grow again.',
  transport: {
    group: 'Play',
    play: 'Play',
    pause: 'Pause',
    place: 'Place in time',
    how: 'Speed and strength',
    speed: 'Speed',
    /** A speed as a factor of how fast it was filmed. */
    times: (speed: number) => `${factors.format(speed)}×`,
    gain: 'How far branches move',
    calm: 'calm',
    asIs: 'as measured',
    stronger: (gain: number) => `${factors.format(gain)}×`,
    /** A place in time, as one looks at it and as it is read aloud. */
    frame: (frame: number, frames: number) => `${whole(frame + 1)} / ${whole(frames)}`,
    back: 'back to the start',
    seconds: (seconds: number) => `${tenths.format(seconds)} s`,
    aloud: (frame: string, seconds: number) => `${frame ? `frame ${frame}, ` : ''}${tenths.format(seconds)} seconds`,
  },
} as const
