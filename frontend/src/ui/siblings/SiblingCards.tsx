import { useLayoutEffect, useRef } from 'preact/hooks'
import type { Model } from '../../api/types'
import { fileName } from '../../studio/project'
import { groveOf, siblingsOf, treeOf } from '../../studio/variants'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useLoaded } from '../parts/useLoaded'
import { useStore, useStudio } from '../parts/useStore'
import { portraitOf } from './portraits'

const { siblings: words } = text

/** The tree and its siblings, each with a picture: a click shows it, and each can be downloaded. */
export function SiblingCards() {
  const model = useStore(state => state.model)
  const { store } = useStudio()
  const list = useRef<HTMLUListElement>(null)
  // The button that was pressed is far below.
  useLayoutEffect(() => list.current?.closest('.panel')?.scrollTo?.({ top: 0 }), [model?.info.id])
  if (!model) return null
  const { info, sibling } = model
  const numbers = Array.from({ length: siblingsOf(info) + 1 }, (_, at) => at)
  const grove = groveOf(info)
  return (
    <>
      <ul class="sibling-cards" ref={list} aria-label={words.list}>
        {numbers.map(number => (
          <Card key={`${info.id}/${number}`} model={info} number={number} isShown={number === sibling} />
        ))}
      </ul>
      <div class="sibling-actions">
        <button type="button" class="button outlined" onClick={() => store.set({ dialog: 'grove' })}>
          <Icon path={ICONS.trees} />
          {words.grove.open}
        </button>
        {grove && (
          <a class="button outlined" href={grove} download={fileName(info.name, '.grove.glb')}>
            <Icon path={ICONS.download} />
            {words.scene}
          </a>
        )}
      </div>
    </>
  )
}

interface CardProps {
  readonly model: Model
  readonly number: number
  readonly isShown: boolean
}

function Card({ model, number, isShown }: CardProps) {
  const { grower } = useStudio()
  const url = treeOf(model, 1, number)!
  const name = number ? words.one(number) : words.own
  const picture = useLoaded(async () => portraitOf(url, address => grower.file(address)), [url])
  return (
    <li class="sibling-card">
      <button
        type="button"
        class="sibling-show"
        aria-pressed={isShown}
        aria-label={words.open(name)}
        title={words.open(name)}
        onClick={() => void grower.choose(1, number)}
      >
        <span class="sibling-picture">{picture && <img src={picture} alt="" />}</span>
        <span>{name}</span>
      </button>
      <a
        class="button square"
        href={url}
        download={fileName(model.name, number ? `.s${number}.glb` : '.glb')}
        aria-label={words.download(name)}
        title={words.download(name)}
      >
        <Icon path={ICONS.download} />
      </a>
    </li>
  )
}
