import { useEffect, useRef, useState } from 'preact/hooks'
import type { Drawn, GroveView } from '../../preview/grove/groveView'
import { siblingsOf, treeOf } from '../../studio/variants'
import { text } from '../../text'
import { useStore, useStudio } from '../parts/useStore'
import { Dialog } from '../start/Dialog'
import './groveDialog.css'

const { grove: words } = text.siblings
const [LEAST, MOST, STEP, FIRST] = [10, 200, 10, 60]
const TURN = Math.PI / 18
const ZOOM = 1.2
/** How far a key turns the camera, and how much closer it brings it. */
const KEYS: Readonly<Record<string, (view: GroveView) => void>> = {
  ArrowLeft: view => view.orbit(-TURN, 0),
  ArrowRight: view => view.orbit(TURN, 0),
  ArrowUp: view => view.orbit(0, -TURN / 2),
  ArrowDown: view => view.orbit(0, TURN / 2),
  '+': view => view.zoom(ZOOM),
  '=': view => view.zoom(ZOOM),
  '-': view => view.zoom(1 / ZOOM),
}

/** A grove of the tree and its siblings, up to 200 of them. */
export function GroveDialog() {
  const canvas = useRef<HTMLCanvasElement>(null)
  const [count, setCount] = useState(FIRST)
  const { view, drawn, isBad } = useGrove(canvas, count)
  const change = (next: number) => {
    setCount(next)
    view.current?.plant(next)
  }
  const press = (event: KeyboardEvent) => {
    const turn = KEYS[event.key]
    if (!turn || !view.current) return
    event.preventDefault()
    turn(view.current)
  }
  return (
    <Dialog title={words.title} class="grove-dialog">
      <div class="grove-stage">
        {/* biome-ignore lint/a11y/noInteractiveElementToNoninteractiveRole: keys turn what it shows */}
        <canvas
          ref={canvas}
          tabIndex={0}
          role="application"
          aria-label={words.label}
          data-calls={drawn?.calls}
          data-triangles={drawn?.triangles}
          onKeyDown={press}
        />
        {!drawn && <p class={isBad ? 'grove-note fault' : 'grove-note'}>{isBad ? words.failed : words.loading}</p>}
      </div>
      <div class="grove-foot">
        <label>
          {words.count}
          <input
            type="range"
            min={LEAST}
            max={MOST}
            step={STEP}
            value={count}
            onInput={event => change(Number(event.currentTarget.value))}
          />
          <output>{count}</output>
        </label>
        <p class="soft">{drawn && words.facts(drawn.trees, drawn.calls, drawn.triangles)}</p>
      </div>
    </Dialog>
  )
}

/** Show the shown model's trees on a canvas; return the view, and what its last frame took. */
function useGrove(canvas: { readonly current: HTMLCanvasElement | null }, count: number) {
  const { grower } = useStudio()
  const model = useStore(state => state.model?.info ?? null)
  const view = useRef<GroveView | null>(null)
  const [drawn, setDrawn] = useState<Drawn | null>(null)
  const [isBad, setBad] = useState(false)
  useEffect(() => {
    let ended = false
    const begin = async () => {
      const numbers = Array.from({ length: siblingsOf(model!) + 1 }, (_, at) => at)
      const glbs = Promise.all(numbers.map(number => grower.file(treeOf(model!, 1, number)!)))
      const { GroveView } = await import('../../preview/grove/groveView')
      if (ended) return
      const dark = matchMedia('(prefers-color-scheme: dark)').matches
      view.current = new GroveView(canvas.current!, dark, setDrawn)
      await view.current.show(await glbs, count)
    }
    if (model) begin().catch(() => setBad(true))
    return () => {
      ended = true
      view.current?.end()
      view.current = null
    }
  }, [model])
  return { view, drawn, isBad }
}
