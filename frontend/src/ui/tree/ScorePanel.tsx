import { useMemo } from 'preact/hooks'
import { withVariant } from '../../studio/variants'
import { text } from '../../text'
import { useStore } from '../parts/useStore'
import { type Figure, figuresOfModel, judgementOf } from './figures'
import { type Measure, measuresOf } from './measures'
import { Panel } from './Panel'
import './scorePanel.css'

/** A value of more letters has a line of its own. */
const LONG = 20

/** The panel that says how well the model turned out and what it measures, each figure with what it means. */
export function ScorePanel() {
  const info = useStore(state => state.model?.info ?? null)
  const variant = useStore(state => state.model?.variant ?? 1)
  const shown = useMemo(() => info && withVariant(info, variant), [info, variant])
  const measures = shown ? measuresOf(shown) : []
  const { title, lead } = text.score.measures
  return (
    <Panel id="score" title={text.score.title}>
      <p class="judgement">{shown?.score ? judgementOf(shown) : ''}</p>
      <dl class="figures">
        {(shown ? figuresOfModel(shown) : []).map(figure => (
          <FigureRow key={figure.row} {...figure} />
        ))}
      </dl>
      <section aria-labelledby="measures" hidden={measures.length === 0}>
        <h3 class="measures-title" id="measures">
          {title}
        </h3>
        <p class="soft measures-lead">{lead}</p>
        <dl class="measures">
          {measures.map(measure => (
            <MeasureRow key={measure.name} {...measure} />
          ))}
        </dl>
      </section>
    </Panel>
  )
}

function FigureRow({ label, value, why }: Figure) {
  return (
    <div class="figure">
      <dt>{label}</dt>
      <dd class="figure-value">{value}</dd>
      <dd class="figure-why">{why}</dd>
    </div>
  )
}

function MeasureRow({ name, label, value, range, basis, why }: Measure) {
  return (
    <div class={value.length > LONG ? 'measure long' : 'measure'} data-measure={name}>
      <dt>{label}</dt>
      <dd class="measure-value">
        <span>{value}</span>
        {range && <span class="measure-range">{range}</span>}
      </dd>
      <dd class="measure-sure">
        {basis && (
          <span class="measure-basis" title={basis[1]}>
            {basis[0]}
          </span>
        )}
      </dd>
      <dd class="figure-why">{why}</dd>
    </div>
  )
}
