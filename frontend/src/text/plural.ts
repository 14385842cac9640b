import { LANGUAGE, whole } from './numbers'

const cardinal = new Intl.PluralRules(LANGUAGE)

/** The forms of a sentence by the plural rules of the page's language; `#` stands for the number. */
export type PluralForms = Readonly<Partial<Record<Intl.LDMLPluralRule, string>>> & { readonly other: string }

/** Return the form that goes with a count, with the count in the place of `#`. */
export function plural(count: number, forms: PluralForms): string {
  return (forms[cardinal.select(count)] ?? forms.other).replace('#', whole(count))
}
