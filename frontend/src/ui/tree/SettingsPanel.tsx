import { type ComponentProps, Fragment, type RefObject } from 'preact'
import { useRef, useState } from 'preact/hooks'
import type { Limits, Settings } from '../../api/types'
import type { State } from '../../state'
import { text } from '../../text'
import type { Span } from '../parts/spans'
import { useStore, useStudio } from '../parts/useStore'
import { type Choice, NumberField, SelectField, SeveralField, ToggleField } from './fields'
import { AnotherButton } from './growButtons'
import { growthStatusOf } from './growthStatus'
import { OwnPicture } from './OwnPicture'
import { Panel } from './Panel'
import { type Allowed, defaultsOf, FIRST_GROUP, type Group, groupsOf, readable, type Value } from './settingGroups'
import { type Tab, Tabs } from './Tabs'
import './settingsPanel.css'

/** The panel of settings, and which group of them it shows. */
export interface SettingsView {
  readonly panelRef: RefObject<HTMLDivElement | null>
  readonly group: string
  choose(group: string): void
  /** Open the panel with a group, by its name. */
  open(group: string): void
}

const SEED: Span = { min: 0, max: Number.MAX_SAFE_INTEGER, whole: true }

/** Return which settings are shown, and how to open them. */
export function useSettingsView(): SettingsView {
  const panelRef = useRef<HTMLDivElement>(null)
  const [group, choose] = useState(FIRST_GROUP)
  const open = (name: string) => {
    choose(name)
    panelRef.current?.showPopover()
  }
  return { panelRef, group, choose, open }
}

/** The panel with every setting that the service takes, the seed and the person's own pictures. */
export function SettingsPanel({ panelRef, group, choose }: SettingsView) {
  const limits = useStore(state => state.limits)
  const [closings, setClosings] = useState(0)
  return (
    <Panel id="settings" title={text.settings.title} panelRef={panelRef} closed={() => setClosings(count => count + 1)}>
      {/* What was written and not chosen is gone when the panel is opened again. */}
      <div class="settings" key={closings}>
        {limits && (
          <Tabs id="settings" label={text.settings.groupsLabel} tabs={tabsOf(limits)} chosen={group} choose={choose} />
        )}
      </div>
      <Foot />
    </Panel>
  )
}

function tabsOf(limits: Limits): Tab[] {
  return groupsOf(limits).map(group => ({ ...group, content: <GroupFields {...group} /> }))
}

function GroupFields({ name, settings }: Group) {
  const lead = text.settings.leads[name]
  return (
    <>
      {lead && <p class="settings-lead">{lead}</p>}
      {settings.map(([setting, allowed]) => (
        <Fragment key={setting}>
          <SettingField name={setting} allowed={allowed} />
          {setting === 'species' && (
            <>
              <OwnPicture kind="leaf" />
              <OwnPicture kind="fruit" />
            </>
          )}
        </Fragment>
      ))}
      {name === FIRST_GROUP && <SeedField />}
    </>
  )
}

interface FieldProps {
  readonly name: string
  readonly allowed: Allowed
}

/** The field for one setting, by what the service says of it. */
function SettingField({ name, allowed }: FieldProps) {
  const { store } = useStudio()
  const settings = useStore(state => state.settings) as Settings & Record<string, Value>
  const chosen = settings[name] ?? allowed.default
  const choose = (value: Value) => store.set({ settings: { ...store.state.settings, [name]: value } })
  const { min = 0, max = 1, whole = false, names, several, toggle } = allowed
  const words = { name, ...(text.settings.known[name] ?? { label: readable(name), why: allowed.meaning }) }
  const choices = (names ?? []).map((key): Choice => [key, words.names?.[key] ?? readable(key)])
  if (toggle) return <ToggleField {...words} chosen={chosen === true} choose={choose} />
  if (several) return <SeveralField {...words} choices={choices} chosen={chosen as readonly string[]} choose={choose} />
  if (names) return <SelectField {...words} choices={choices} chosen={String(chosen)} choose={choose} />
  const Field = name === 'height' ? HeightField : NumberField
  return <Field {...words} span={{ min, max, whole }} chosen={Number(chosen)} choose={choose} since={settings} />
}

/** The field for the height; a measured line takes its place. */
function HeightField(props: ComponentProps<typeof NumberField>) {
  const scale = useStore(state => state.history.present.scale)
  const distance = useStore(state => state.history.present.distance)
  const measured = scale ?? distance
  const note = measured ? noteOn(measured.metres, !scale) : ''
  return <NumberField {...props} disabled={measured !== undefined} note={note} />
}

/** Return what takes the height's place: a measured line, or the distance between two photos. */
function noteOn(metres: number, isDistance: boolean): string {
  const { heightMeasured, heightByDistance } = text.settings
  return (isDistance ? heightByDistance : heightMeasured)(text.metres(metres))
}

function SeedField() {
  const { store } = useStudio()
  const seed = useStore(state => state.seed)
  return (
    <NumberField
      name="seed"
      label={text.settings.seed}
      why={text.settings.seedWhy}
      span={SEED}
      slides={false}
      chosen={seed}
      choose={chosen => store.set({ seed: chosen })}
      since={seed}
    >
      <AnotherButton />
    </NumberField>
  )
}

function Foot() {
  const { store } = useStudio()
  const onlyFiles = useStore(onlyFilesChanged)
  const reset = () => store.set({ settings: defaultsOf(store.state.limits) })
  return (
    <footer class="settings-foot">
      <button type="button" class="button outlined" onClick={reset}>
        {text.settings.reset}
      </button>
      <p class="settings-again" role="status">
        {onlyFiles ? text.settings.fileAgain : ''}
      </p>
    </footer>
  )
}

function onlyFilesChanged(state: State): boolean {
  return growthStatusOf(state) === 'filesChanged'
}
