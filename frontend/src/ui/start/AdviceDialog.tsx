import { text } from '../../text'
import { useStore } from '../parts/useStore'
import { Advice } from './Advice'
import { PhotoRing } from './PhotoRing'

const { advice: words } = text.capture

/** How to photograph a tree so that it can be measured; it leads back to photos that were chosen. */
export function AdviceDialog() {
  const limits = useStore(state => state.limits)
  const hasOffer = useStore(state => state.offer !== null)
  return (
    <Advice
      title={words.title}
      lead={words.lead}
      points={words.points}
      picture={<PhotoRing label={words.ring} />}
      back={hasOffer ? 'photos' : null}
    >
      {limits && <p class="soft">{words.least(limits.capture_photos_min, limits.capture_photos_max)}</p>}
    </Advice>
  )
}
