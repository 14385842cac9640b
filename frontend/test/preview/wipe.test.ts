// @vitest-environment jsdom
import { beforeEach, describe, expect, it } from 'vitest'
import { Wipe } from '../../src/preview/wipe'

const RECT = { x: 100, y: 0, width: 200, height: 300 }
const VIEWPORT = { width: 400, height: 300 }

describe('the wipe', () => {
  let host: HTMLElement
  let wipe: Wipe
  const slider = () => host.querySelector<HTMLElement>('[role=slider]')!
  const photo = () => host.querySelector('img')!
  const press = (key: string) => slider().dispatchEvent(new KeyboardEvent('keydown', { key, cancelable: true }))

  beforeEach(() => {
    host = document.createElement('div')
    wipe = new Wipe(host, 'Photo or tree')
    wipe.show('blob:a')
    wipe.place(RECT, VIEWPORT)
  })

  it('lies exactly over the rectangle, first divided in the middle', () => {
    expect(photo().style).toMatchObject({ left: '100px', top: '0px', width: '200px', height: '300px' })
    expect(photo().style.clipPath).toBe('inset(0 100px 0 0)')
    expect(slider().style.left).toBe('200px')
    expect(slider().getAttribute('aria-label')).toBe('Photo or tree')
  })

  it.each([
    [0, '300px', '100'],
    [0.25, '250px', '75'],
    [1, '100px', '0'],
    [7, '100px', '0'],
  ])('shows a share of %f of the tree with its handle at %s', (fraction, left, percent) => {
    wipe.set(fraction)
    expect(slider().style.left).toBe(left)
    expect(slider().getAttribute('aria-valuenow')).toBe(percent)
  })

  it('moves with arrow keys, to the ends with Home and End, and ignores Tab', () => {
    press('ArrowRight')
    expect(slider().getAttribute('aria-valuenow')).toBe('52')
    press('ArrowLeft')
    press('ArrowDown')
    expect(slider().getAttribute('aria-valuenow')).toBe('48')
    press('Home')
    expect(slider().getAttribute('aria-valuenow')).toBe('0')
    press('End')
    expect(slider().getAttribute('aria-valuenow')).toBe('100')
    expect(press('Tab')).toBe(true)
    expect(press('Home')).toBe(false)
  })

  it('stays within the host where the photo is zoomed beyond it', () => {
    wipe.place({ x: -300, y: -100, width: 1000, height: 500 }, VIEWPORT)
    expect(slider().style.left).toBe('200px')
    expect(photo().style.clipPath).toBe('inset(0 500px 0 0)')
  })

  it('is hidden, and not in the tab order, away from the photo’s view and without a photo', () => {
    wipe.place(null, VIEWPORT)
    expect([slider().hidden, photo().classList.contains('preview-gone')]).toEqual([true, true])
    wipe.place(RECT, VIEWPORT)
    expect(slider().hidden).toBe(false)
    wipe.show(null)
    expect(slider().hidden).toBe(true)
  })

  it('shows a video’s frame in the photo’s place, and then the photo again', () => {
    const film = document.createElement('canvas')
    wipe.showFilm(film)
    expect([film.style.left, film.style.clipPath, photo().hidden]).toEqual(['100px', 'inset(0 100px 0 0)', true])
    wipe.showFilm(null)
    expect([film.isConnected, photo().hidden, photo().style.left]).toEqual([false, false, '100px'])
  })
})
