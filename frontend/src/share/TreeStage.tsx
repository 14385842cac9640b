import { useEffect, useRef, useState } from 'preact/hooks'
import { Playhead } from '../playhead'
import type { PreviewStatus } from '../preview/status'
import { sharePageText as text } from '../text/share'
import { loadTree } from './sharedTree'

interface Props {
  readonly link: string
  readonly name: string
  /** Whether the photo may be seen. */
  readonly photo: boolean
}

/** The tree in 3D; its picture until it is there, and where the browser has no 3D. */
export function TreeStage({ link, name, photo }: Props) {
  const place = useRef<HTMLDivElement>(null)
  const { shown, fault } = useTree(place, link, photo)
  return (
    <div class="share-stage" data-shown={shown || undefined}>
      <div class="share-preview" ref={place} />
      <img class="share-poster" src={`${link}/preview.png`} alt={text.picture(name)} hidden={shown} />
      <p class="share-notice" role="status" hidden={shown}>
        {fault ?? text.loading}
      </p>
    </div>
  )
}

/** Show a tree in an element; says whether it is there, or what is wrong. */
function useTree(place: { readonly current: HTMLDivElement | null }, link: string, photo: boolean) {
  const [shown, setShown] = useState(false)
  const [fault, setFault] = useState<string | null>(null)
  useEffect(() => {
    let end = () => {}
    const begin = async () => {
      const [{ Preview }, glb] = await Promise.all([import('../preview/preview'), loadTree(link)])
      if (!glb) return setFault(text.unreachable)
      const onStatus = ({ webgl }: PreviewStatus) => webgl === 'absent' && setFault(text.noWebgl)
      const preview = new Preview(place.current!, { ...STILL, onStatus, playhead: new Playhead() })
      end = () => preview.end()
      if (photo) preview.showPhoto(`${link}/photo.jpg`)
      await preview.showModel(glb)
      setShown(place.current!.dataset.state === 'model')
    }
    begin().catch(() => setFault(text.unreachable))
    return () => end()
  }, [link, photo])
  return { shown, fault }
}

/** What the preview is made with where nothing is edited. */
const STILL = {
  labels: { wipe: text.wipe, canvas: text.canvas },
  reducedMotion: () => matchMedia('(prefers-reduced-motion: reduce)').matches,
  onPhoto: () => {},
  edits: { picked: () => {}, moved: () => {}, drew: () => {} },
}
