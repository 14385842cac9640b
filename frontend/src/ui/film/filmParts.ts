/** What the page needs for a clip alone: it is loaded when one is opened. */
export { ClipScreen } from './ClipScreen'
export { FilmStrip } from './FilmStrip'
export { Film } from './film'
export { showFilm } from './screen'
