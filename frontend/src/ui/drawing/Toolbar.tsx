import type { State, Tool } from '../../state'
import { isEmpty } from '../../strokes'
import { text } from '../../text'
import { Icon } from '../parts/Icon'
import { ICONS } from '../parts/icons'
import { withCtrl } from '../parts/shortcutKeys'
import { useStore, useStudio } from '../parts/useStore'
import { StrokeList } from './StrokeList'
import './toolbar.css'

const TOOLS = ['crown', 'branch', 'scale', 'select'] as const
const KEYS: Readonly<Record<Tool, string>> = { crown: 'C', branch: 'B', scale: 'M', select: 'V' }

/** The drawing tools, and the buttons that edit strokes. */
export function Toolbar() {
  const { strokes } = useStudio()
  const { tools: words } = text
  return (
    <div class="toolbar" role="group" aria-label={words.group}>
      {TOOLS.map(tool => (
        <ToolButton key={tool} tool={tool} />
      ))}
      <span class="tool-rule" />
      <EditButton
        label={words.withKey(words.undo, withCtrl('Z'))}
        icon={ICONS.undo}
        canEdit={({ history }) => history.past.length > 0}
        edit={() => strokes.undo()}
      />
      <EditButton
        label={words.withKey(words.redo, withCtrl('Shift+Z'))}
        icon={ICONS.redo}
        canEdit={({ history }) => history.future.length > 0}
        edit={() => strokes.redo()}
      />
      <EditButton
        label={words.withKey(words.remove, 'Del')}
        icon={ICONS.remove}
        canEdit={({ selection }) => selection !== null}
        edit={() => strokes.remove()}
      />
      <EditButton
        label={words.clear}
        icon={ICONS.clear}
        canEdit={({ history }) => !isEmpty(history.present)}
        edit={() => strokes.clear()}
      />
      <StrokeList />
    </div>
  )
}

function ToolButton({ tool }: { readonly tool: Tool }) {
  const { strokes } = useStudio()
  const isChosen = useStore(state => state.tool === tool)
  const isSketch = useStore(({ sheets }) => sheets?.source === 'sketch')
  return (
    <button
      type="button"
      class="button tool tool-kind"
      data-tool={tool}
      title={text.tools.withKey(text.tools[tool], KEYS[tool])}
      aria-keyshortcuts={KEYS[tool]}
      aria-pressed={isChosen}
      hidden={tool === 'scale' && isSketch} // lengths are measured on photos only
      onClick={() => strokes.chooseTool(tool)}
    >
      <Icon path={ICONS[tool]} />
      <span class="tool-label">{text.tools[tool]}</span>
    </button>
  )
}

interface EditProps {
  readonly label: string
  readonly icon: (typeof ICONS)[keyof typeof ICONS]
  canEdit(state: State): boolean
  edit(): void
}

/** A button that is dimmed while it can do nothing, but keeps the focus. */
function EditButton({ label, icon, canEdit, edit }: EditProps) {
  const isPossible = useStore(canEdit)
  return (
    <button
      type="button"
      class="button tool tool-edit"
      title={label}
      aria-label={label}
      aria-disabled={!isPossible}
      onClick={() => isPossible && edit()}
    >
      <Icon path={icon} />
    </button>
  )
}
