import { useState } from 'preact/hooks'
import type { Line } from '../../strokes'
import { siblingsOf } from '../../studio/variants'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { IconButton } from '../parts/IconButton'
import { ICONS } from '../parts/icons'
import { useStore, useStudio } from '../parts/useStore'
import { NumberField } from '../tree/fields'
import { canGrow, growthStatusOf } from '../tree/growthStatus'
import { OutlineField, type OutlineName } from './OutlineField'
import { SiblingCards } from './SiblingCards'
import './siblings.css'

const { siblings: words } = text
const COUNT = { min: 1, max: 16, whole: true }
const FIRST_COUNT = 6
const SEED = { min: 0, max: 2 ** 31 - 1, whole: true }
const RANDOM_SEEDS = 1_000_000

/** Siblings of the shown tree: how they are grown, and those that it has. */
export function Siblings() {
  const has = useStore(({ model }) => (model ? siblingsOf(model.info) : 0))
  return (
    <>
      {has > 0 ? <SiblingCards /> : <p class="soft">{words.lead}</p>}
      <Order known={has} />
    </>
  )
}

/** The form that has siblings grown. */
function Order({ known }: { readonly known: number }) {
  const { grower } = useStudio()
  const own = useStore(({ model }) => model?.info.seed ?? 0)
  const can = useStore(state => canGrow(growthStatusOf(state)))
  const [count, setCount] = useState(known || FIRST_COUNT)
  const [seed, setSeed] = useState(own)
  const [shape, setShape] = useState<OutlineName>('none')
  const [drawn, setDrawn] = useState<Line | null>(null)
  const isOwn = shape === 'drawn' || shape === 'picture'
  const isReady = can && !(isOwn && !drawn)
  const grow = () => {
    const envelope = isOwn ? drawn && { points: drawn } : shape === 'none' ? null : shape
    if (isReady) void grower.growSiblings({ count, seed, scene: true, ...(envelope && { envelope }) })
  }
  return (
    <div class="siblings-order">
      <NumberField
        name="siblings-count"
        label={words.count}
        why=""
        span={COUNT}
        chosen={count}
        choose={setCount}
        since={count}
      />
      <NumberField
        name="siblings-seed"
        label={words.seed}
        why=""
        span={SEED}
        slides={false}
        chosen={seed}
        choose={setSeed}
        since={seed}
      >
        <IconButton
          label={words.another}
          icon={ICONS.dice}
          onClick={() => setSeed(Math.floor(Math.random() * RANDOM_SEEDS))}
        />
      </NumberField>
      <OutlineField shape={shape} choose={setShape} drawn={drawn} draw={setDrawn} />
      <button type="button" class="button primary siblings-grow" aria-disabled={!isReady} onClick={grow}>
        <Icon path={ICONS.trees} />
        {words.grow(count)}
      </button>
    </div>
  )
}
