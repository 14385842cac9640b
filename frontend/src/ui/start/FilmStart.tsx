import { text } from '../../text'
import { chooseVideo, offerVideo } from '../parts/files'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useStudio } from '../parts/useStore'
import { FilmingPicture } from './FilmingPicture'

const { welcome: words } = text.clip

/** The start with a video of a tree: advice, and the way to choose one. */
export function FilmStart() {
  const studio = useStudio()
  return (
    <div class="many-start">
      <FilmingPicture />
      <div class="many-words">
        <p>{words.lead}</p>
        <div class="many-buttons">
          <button type="button" class="button outlined" onClick={() => chooseVideo(file => offerVideo(studio, file))}>
            <Icon path={ICONS.film} />
            {words.choose}
          </button>
        </div>
        <span class="soft">{words.formats}</span>
        <button type="button" class="button many-advice" onClick={() => studio.store.set({ dialog: 'filming' })}>
          {words.advice}
        </button>
      </div>
    </div>
  )
}
