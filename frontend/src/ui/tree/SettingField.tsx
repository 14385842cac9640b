import type { ComponentProps } from 'preact'
import type { Settings } from '../../api/types'
import { text } from '../../text'
import { useStore, useStudio } from '../parts/useStore'
import { type Choice, NumberField, SelectField, SeveralField, ToggleField } from './fields'
import { type Allowed, readable, type Value } from './settingGroups'

interface Props {
  readonly name: string
  readonly allowed: Allowed
}

/** The field for one setting, by what the service says of it. */
export function SettingField({ name, allowed }: Props) {
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
  const note = scale ? text.settings.heightMeasured(text.metres(scale.metres)) : ''
  return <NumberField {...props} disabled={scale !== null} note={note} />
}
