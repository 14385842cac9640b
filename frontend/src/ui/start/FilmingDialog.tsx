import { text } from '../../text'
import { useStore } from '../parts/useStore'
import { Advice } from './Advice'
import { FilmingPicture } from './FilmingPicture'

const { advice: words, welcome } = text.clip

/** How to film a tree so that its motion can be measured; it leads back to a video that was chosen. */
export function FilmingDialog() {
  const hasOffer = useStore(state => state.clipOffer !== null)
  return (
    <Advice
      title={words.title}
      lead={welcome.lead}
      points={words.points}
      picture={<FilmingPicture />}
      back={hasOffer ? 'clip' : null}
    >
      <p class="soft">{welcome.formats}</p>
    </Advice>
  )
}
