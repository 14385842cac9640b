import './filmingPicture.css'

/** A tree in the frame of a camera on a tripod; it bends to and fro. */
export function FilmingPicture() {
  return (
    <svg class="filming-picture" viewBox="0 0 240 150" aria-hidden="true">
      <rect class="filming-frame" x="66" y="10" width="150" height="118" rx="6" />
      <path class="filming-ground" d="M70 120h142" />
      <g class="filming-tree">
        <path class="filming-wood" d="M141 120c0-22-1-30 0-46M141 92c-8-6-13-12-16-20M141 84c7-4 12-9 17-18" />
        <path
          class="filming-leaves"
          d="M120 84c-12 2-20-8-16-18-6-10 4-22 14-20 4-14 26-20 36-8 14-2 24 10 20 22 8 12-2 24-14 23-10 8-30 9-40 1z"
        />
      </g>
      <path class="filming-camera" d="M14 70h30v20H14zM44 76l10-5v18l-10-5M29 90l-12 36M29 90l12 36M29 90v34" />
    </svg>
  )
}
