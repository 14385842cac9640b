import { useEffect, useState } from 'preact/hooks'
import { sharePageText as text } from '../text/share'
import { CopyField } from '../ui/parts/CopyField'
import { Icon } from '../ui/parts/Icon'
import { ICONS } from '../ui/parts/icons'
import { Sapling } from '../ui/parts/Sapling'
import { type Answer, askFor, embedCode, type Lack, type SharedModel } from './sharedTree'
import { TreeStage } from './TreeStage'
import './sharePage.css'

interface Props {
  /** The address of the link. */
  readonly link: string
  /** Whether the page stands in the frame of another one. */
  readonly embedded: boolean
}

/** The page of a shared tree: the tree in 3D, its name, and what one may take along. */
export function SharePage({ link, embedded }: Props) {
  const [answer, setAnswer] = useState<Answer | null>(null)
  const [asked, setAsked] = useState(0)
  useEffect(() => {
    setAnswer(null)
    void askFor(link).then(setAnswer)
  }, [link, asked])
  const tree = answer && 'tree' in answer ? answer.tree : null
  useEffect(() => {
    if (tree) document.title = text.title(nameOf(tree))
  }, [tree])
  if (answer && 'lack' in answer) return <Lacking lack={answer.lack} again={() => setAsked(count => count + 1)} />
  return (
    <main class={embedded ? 'share is-embedded' : 'share'}>
      {tree ? (
        <TreeStage link={link} name={nameOf(tree)} photo={tree.photo} />
      ) : (
        <p class="share-loading">{text.loading}</p>
      )}
      {tree && (embedded ? <Caption tree={tree} link={link} /> : <About tree={tree} link={link} />)}
    </main>
  )
}

function nameOf({ name }: SharedModel): string {
  return name || text.unnamed
}

function Lacking({ lack, again }: { readonly lack: Lack; again(): void }) {
  return (
    <main class="share-lacking">
      <Sapling />
      <p role="alert">{text[lack]}</p>
      <button type="button" class="button outlined" hidden={lack !== 'unreachable'} onClick={again}>
        {text.again}
      </button>
    </main>
  )
}

/** What is said of the tree below it, and what one may take along. */
function About({ tree, link }: { readonly tree: SharedModel; readonly link: string }) {
  const name = nameOf(tree)
  return (
    <footer class="share-about">
      <div class="share-words">
        <h1>{name}</h1>
        <p>{tree.height ? text.height(tree.height) : text.app}</p>
      </div>
      {tree.download && (
        <a class="button primary" href={`${link}/tree.glb`} download>
          <Icon path={ICONS.download} />
          {text.download(tree.bytes)}
        </a>
      )}
      <details class="share-embed">
        <summary class="button outlined">{text.embed}</summary>
        <CopyField label={text.embedHint} value={embedCode(link, name)} copy={text.copy} copied={text.copied} />
      </details>
    </footer>
  )
}

/** The line over an embedded tree, which leads to its page. */
function Caption({ tree, link }: { readonly tree: SharedModel; readonly link: string }) {
  return (
    <a class="share-caption" href={link} target="_blank" rel="noopener">
      {nameOf(tree)} <span>{text.app}</span>
    </a>
  )
}
