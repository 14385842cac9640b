import { Fragment, type RefObject } from 'preact'
import { useRef, useState } from 'preact/hooks'
import type { Limits } from '../../api/types'
import type { State } from '../../state'
import { text } from '../../text'
import type { Span } from '../parts/spans'
import { useStore, useStudio } from '../parts/useStore'
import { NumberField } from './fields'
import { AnotherButton } from './growButtons'
import { growthStatusOf } from './growthStatus'
import { OwnPicture } from './OwnPicture'
import { Panel } from './Panel'
import { SettingField } from './SettingField'
import { defaultsOf, FIRST_GROUP, type Group, groupsOf } from './settingGroups'
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
