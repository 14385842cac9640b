import type { ComponentChildren } from 'preact'
import type { State } from '../../state'
import { Dialog } from './Dialog'
import './advice.css'

interface Props {
  readonly title: string
  readonly lead: string
  /** What to do, and why. */
  readonly points: readonly (readonly [string, string])[]
  readonly picture: ComponentChildren
  /** The dialog that it leads back to. */
  readonly back: State['dialog']
  /** The last words. */
  readonly children?: ComponentChildren
}

/** A dialog that says how to take what a tree is made from. */
export function Advice({ title, lead, points, picture, back, children }: Props) {
  return (
    <Dialog title={title} class="advice" after={{ dialog: back }}>
      <div class="advice-body">
        {picture}
        <div>
          <p class="advice-lead">{lead}</p>
          <dl class="advice-points">
            {points.map(([what, why]) => (
              <div key={what}>
                <dt>{what}</dt>
                <dd>{why}</dd>
              </div>
            ))}
          </dl>
          {children}
        </div>
      </div>
    </Dialog>
  )
}
