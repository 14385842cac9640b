import { text } from '../../text'
import { useStore } from '../parts/useStore'
import { Dialog } from './Dialog'
import { PhotoRing } from './PhotoRing'
import './advice.css'

const { advice: words } = text.capture

/** How to photograph a tree so that it can be measured; it leads back to photos that were chosen. */
export function AdviceDialog() {
  const limits = useStore(state => state.limits)
  const hasOffer = useStore(state => state.offer !== null)
  return (
    <Dialog title={words.title} class="advice" after={{ dialog: hasOffer ? 'photos' : null }}>
      <div class="advice-body">
        <PhotoRing label={words.ring} />
        <div>
          <p class="advice-lead">{words.lead}</p>
          <dl class="advice-points">
            {words.points.map(([what, why]) => (
              <div key={what}>
                <dt>{what}</dt>
                <dd>{why}</dd>
              </div>
            ))}
          </dl>
          {limits && <p class="soft">{words.least(limits.capture_photos_min, limits.capture_photos_max)}</p>}
        </div>
      </div>
    </Dialog>
  )
}
