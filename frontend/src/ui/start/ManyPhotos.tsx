import { PHOTOS_EXAMPLES, type PhotosExample } from '../../studio/examples'
import { text } from '../../text'
import { chooseFolder, choosePhotos, mayLeave } from '../parts/files'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { useStudio } from '../parts/useStore'
import { PhotoRing } from './PhotoRing'
import './manyPhotos.css'

const { welcome: words, advice } = text.capture
/** How many of an example's photos its card shows. */
const SHOWN = 4

/** The start with many photos of one tree: advice, the ways to choose them, and an example. */
export function ManyPhotos() {
  const studio = useStudio()
  return (
    <div class="many-photos">
      <div class="many-start">
        <PhotoRing label={advice.ring} />
        <div class="many-words">
          <p>{advice.lead}</p>
          <div class="many-buttons">
            <button type="button" class="button outlined" onClick={() => choosePhotos(studio)}>
              <Icon path={ICONS.gallery} />
              {words.choose}
            </button>
            <button type="button" class="button outlined of-folder" onClick={() => chooseFolder(studio)}>
              <Icon path={ICONS.open} />
              {words.folder}
            </button>
          </div>
          <button type="button" class="button many-advice" onClick={() => studio.store.set({ dialog: 'advice' })}>
            {words.advice}
          </button>
        </div>
      </div>
      <ul class="picks">
        {PHOTOS_EXAMPLES.map(example => (
          <PhotosCard key={example.name} example={example} />
        ))}
      </ul>
    </div>
  )
}

/** A bundled tree of many photos. */
function PhotosCard({ example }: { readonly example: PhotosExample }) {
  const studio = useStudio()
  const { name, photos } = example
  const shown = photos.filter((_, at) => at % Math.ceil(photos.length / SHOWN) === 0)
  return (
    <li>
      <button type="button" class="pick" onClick={() => mayLeave(studio) && studio.opener.openPhotosExample(example)}>
        <span class="pick-photo of-many">
          {shown.map(({ url }) => (
            <img key={url} src={url} alt="" loading="lazy" decoding="async" />
          ))}
        </span>
        <span class="pick-name">{text.examples[name] ?? name}</span>
        <span class="pick-when">{words.example(photos.length)}</span>
      </button>
    </li>
  )
}
