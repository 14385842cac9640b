import { useEffect, useState } from 'preact/hooks'

/** Return what `load` resolves to, again whenever one of `inputs` changes; null before, and where it fails. */
export function useLoaded<T>(load: () => Promise<T>, inputs: readonly unknown[]): T | null {
  const [loaded, setLoaded] = useState<T | null>(null)
  useEffect(() => {
    let current = true
    load().then(
      value => current && setLoaded(() => value),
      () => current && setLoaded(null),
    )
    return () => {
      current = false
    }
  }, inputs)
  return loaded
}
