import { text } from '../../text'
import { useStore } from '../parts/useStore'
import { Dialog } from './Dialog'
import { FilmingPicture } from './FilmingPicture'
import './advice.css'

const { advice: words, welcome } = text.clip

/** How to film a tree so that its motion can be measured; it leads back to a video that was chosen. */
export function FilmingDialog() {
  const hasOffer = useStore(state => state.clipOffer !== null)
  return (
    <Dialog title={words.title} class="advice" after={{ dialog: hasOffer ? 'clip' : null }}>
      <div class="advice-body">
        <FilmingPicture />
        <div>
          <p class="advice-lead">{welcome.lead}</p>
          <dl class="advice-points">
            {words.points.map(([what, why]) => (
              <div key={what}>
                <dt>{what}</dt>
                <dd>{why}</dd>
              </div>
            ))}
          </dl>
          <p class="soft">{welcome.formats}</p>
        </div>
      </div>
    </Dialog>
  )
}
