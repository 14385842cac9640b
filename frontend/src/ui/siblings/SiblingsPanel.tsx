import { text } from '../../text'
import { useLoaded } from '../parts/useLoaded'
import { useStore } from '../parts/useStore'
import { Panel } from '../tree/Panel'

/** The panel with other trees of the same kind; what it holds is loaded with the first tree, and stays while others grow. */
export function SiblingsPanel() {
  const hasTree = useStore(({ model }) => model !== null)
  const Parts = useLoaded(async () => (hasTree ? (await import('./Siblings')).Siblings : null), [hasTree])
  return (
    <Panel id="siblings" title={text.siblings.title}>
      {Parts && <Parts />}
    </Panel>
  )
}
