import { accessText } from './text/access'
import { captureText } from './text/capture'
import { clipText } from './text/clip'
import { drawingText } from './text/drawing'
import { filesText } from './text/files'
import { measuredText } from './text/measured'
import { motionText } from './text/motion'
import { scoreText } from './text/score'
import { settingsText } from './text/settings'
import { sharingText } from './text/sharing'
import { sheetsText } from './text/sheets'
import { siblingsText } from './text/siblings'
import { takenText } from './text/taken'
import { treeText } from './text/tree'
import { welcomeText } from './text/welcome'

/** Every English text of the page. */
export const text = {
  ...welcomeText,
  ...drawingText,
  ...treeText,
  access: accessText,
  capture: captureText,
  clip: clipText,
  sharing: sharingText,
  sheets: sheetsText,
  siblings: siblingsText,
  settings: settingsText,
  taken: takenText,
  measured: measuredText,
  motion: motionText,
  score: scoreText,
  files: filesText,
} as const
