import { text } from '../../text'
import { LANGUAGE } from '../../text/numbers'
import { withCtrl } from '../parts/shortcutKeys'
import './shortcutsDialog.css'

const OR = new Intl.ListFormat(LANGUAGE, { type: 'disjunction' })

type Row = readonly [what: string, ...keys: string[]]

const { groups: titles, keys, ...said } = text.shortcuts
const { tools, sheets } = text
const GROUPS: readonly (readonly [title: string, rows: readonly Row[]])[] = [
  [
    titles.draw,
    [
      [tools.crown, 'C'],
      [tools.branch, 'B'],
      [said.rightDrag, said.rightButton],
      [tools.scale, 'M'],
      [tools.select, 'V'],
      [sheets.keys.other, 'S'],
      [sheets.keys.thinner, '[', ']'],
    ],
  ],
  [
    titles.edit,
    [
      [tools.undo, withCtrl('Z')],
      [tools.redo, withCtrl('Shift+Z'), withCtrl('Y')],
      [said.remove, keys.delete],
    ],
  ],
  [
    titles.view,
    [
      [said.zoom, said.wheel, '+', '−'],
      [said.pan, said.spaceDrag],
      [tools.fitWhole, 'F'],
      [tools.toActual, '1'],
      [said.save, withCtrl('S')],
      [said.open, withCtrl('O')],
      [said.grow, 'G'],
      [said.help, '?'],
    ],
  ],
  [
    titles.canvas,
    [
      [said.move, said.arrows],
      [said.pen, keys.enter],
      [said.escape, keys.escape],
    ],
  ],
  [
    titles.tree,
    [
      [said.orbit, said.arrows],
      [said.zoom, '+', '−'],
      [said.views, said.viewKeys],
      [said.leaves, 'L'],
    ],
  ],
]

/** All shortcuts, in groups. */
export function ShortcutsDialog() {
  return (
    <div class="shortcuts">
      {GROUPS.map(([title, rows]) => (
        <section key={title}>
          <h3>{title}</h3>
          <dl>
            {rows.map(row => (
              <Shortcut key={row[0]} row={row} />
            ))}
          </dl>
        </section>
      ))}
    </div>
  )
}

function Shortcut({ row: [what, ...pressed] }: { readonly row: Row }) {
  return (
    <div>
      <dt>{what}</dt>
      <dd>
        {OR.formatToParts(pressed).map(({ type, value }) =>
          type === 'element' ? <kbd key={value}>{value}</kbd> : value,
        )}
      </dd>
    </div>
  )
}
