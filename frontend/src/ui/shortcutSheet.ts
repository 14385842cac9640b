import { text } from '../text'
import { openDialog } from './dialog'
import { el } from './dom'
import { withCtrl } from './shortcutKeys'
import './shortcutSheet.css'

type Row = readonly [what: string, ...keys: string[]]

/** Show every shortcut. */
export function openShortcuts(): void {
  const sheet = el('div', { class: 'shortcuts' })
  for (const [title, rows] of groups()) sheet.append(group(title, rows))
  openDialog(text.shortcuts.title, sheet)
}

function groups(): [string, Row[]][] {
  const { groups: titles, keys, ...said } = text.shortcuts
  const { tools } = text
  return [
    [
      titles.draw,
      [
        [tools.crown, 'C'],
        [tools.branch, 'B'],
        [said.rightDrag, said.rightButton],
        [tools.scale, 'M'],
        [tools.select, 'V'],
        [text.sheets.keys.other, 'S'],
        [text.sheets.keys.thinner, '[', ']'],
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
      titles.photo,
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
        [said.closer, '+', '−'],
        [said.views, `1 ${keys.to} 5`],
        [said.leaves, 'L'],
      ],
    ],
  ]
}

function group(title: string, rows: readonly Row[]): HTMLElement {
  const list = el('dl', {})
  for (const [what, ...keys] of rows) {
    const shown = keys.flatMap((key, index) => [index ? ` ${text.shortcuts.keys.or} ` : '', el('kbd', {}, key)])
    list.append(el('div', {}, el('dt', {}, what), el('dd', {}, ...shown)))
  }
  return el('section', {}, el('h3', {}, title), list)
}
