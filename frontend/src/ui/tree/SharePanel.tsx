import { useEffect, useState } from 'preact/hooks'
import type { Share } from '../../api/types'
import type { State } from '../../state'
import { faultOf } from '../../studio/faultText'
import { text } from '../../text'
import { CopyField } from '../parts/CopyField'
import { useStore, useStudio } from '../parts/useStore'
import { Panel } from './Panel'
import './sharePanel.css'

const USUAL_DAYS = 30

/** The panel with the links to the tree that is shown: made, copied, listed and revoked. */
export function SharePanel() {
  const id = useStore(sharedId)
  return (
    <Panel id="share" title={text.sharing.title}>
      {id && <Shares key={id} id={id} />}
    </Panel>
  )
}

/** Return the id of the tree that links can be made to; null where there are none. */
export function sharedId({ session, model }: State): string | null {
  return session && model?.info.status === 'succeeded' ? model.info.id : null
}

function Shares({ id }: { readonly id: string }) {
  const { made, shares, fault, make, revoke } = useShares(id)
  const canWrite = useStore(({ session }) => session?.member.role !== 'viewer' && !session?.read_only)
  return (
    <div class="shares">
      {canWrite && <ShareForm make={make} />}
      <p class="fault" role="alert" hidden={!fault}>
        {fault}
      </p>
      {made?.url && (
        <CopyField label={text.sharing.made} value={made.url} copy={text.sharing.copy} copied={text.sharing.copied} />
      )}
      <h3>{text.sharing.links}</h3>
      <ul>
        {shares?.map(share => (
          <ShareLine key={share.id} share={share} revoke={canWrite ? () => revoke(share.id) : null} />
        ))}
      </ul>
      <p class="soft" hidden={shares?.length !== 0}>
        {text.sharing.none}
      </p>
    </div>
  )
}

/** The links to a model, the one that was made last, and what can be done with them. */
function useShares(id: string) {
  const { client, store } = useStudio()
  const [shares, setShares] = useState<readonly Share[] | null>(null)
  const [made, setMade] = useState<Share | null>(null)
  const [fault, setFault] = useState<string | null>(null)
  const attempt = async (call: () => Promise<void>) => {
    try {
      await call()
      setShares(await client.listShares(id))
      setFault(null)
    } catch (error) {
      setFault(faultOf(error).text)
    }
  }
  useEffect(() => {
    void attempt(async () => {})
  }, [id])
  const make = (terms: Terms) => attempt(async () => setMade(await client.shareModel(id, terms)))
  const revoke = (share: string) =>
    attempt(async () => {
      await client.revokeShare(share)
      setMade(last => (last?.id === share ? null : last))
      store.announce(text.sharing.revoked)
    })
  return { made, shares, fault, make, revoke }
}

interface Terms {
  readonly days: number
  readonly photo: boolean
  readonly download: boolean
}

function ShareForm({ make }: { make(terms: Terms): void }) {
  const [terms, setTerms] = useState<Terms>({ days: USUAL_DAYS, photo: false, download: true })
  const { sharing } = text
  return (
    <form
      class="share-form"
      onSubmit={event => {
        event.preventDefault()
        make(terms)
      }}
    >
      <p class="soft">{sharing.lead}</p>
      <label class="share-days">
        {sharing.days}
        <select value={terms.days} onChange={event => setTerms({ ...terms, days: Number(event.currentTarget.value) })}>
          {Object.entries(sharing.dayCounts).map(([days, words]) => (
            <option value={days} key={days}>
              {words}
            </option>
          ))}
        </select>
      </label>
      {(['photo', 'download'] as const).map(what => (
        <label class="share-choice" key={what}>
          <input
            type="checkbox"
            checked={terms[what]}
            onChange={event => setTerms({ ...terms, [what]: event.currentTarget.checked })}
          />
          {sharing[what]}
        </label>
      ))}
      <button type="submit" class="button primary">
        {sharing.make}
      </button>
    </form>
  )
}

function ShareLine({ share, revoke }: { readonly share: Share; readonly revoke: (() => void) | null }) {
  const { sharing } = text
  const isOver = share.revoked !== null || Date.parse(share.expires) <= Date.now()
  const terms = [
    share.revoked ? sharing.revokedOn(share.revoked) : (isOver ? sharing.endedOn : sharing.until)(share.expires),
    ...(share.photo ? [sharing.withPhoto] : []),
    ...(share.download ? [] : [sharing.withoutDownload]),
  ]
  return (
    <li class={isOver ? 'share-line is-over' : 'share-line'}>
      <span>{terms.join(', ')}</span>
      {revoke && !isOver && (
        <button type="button" class="button outlined" aria-label={sharing.revokeOf(share.created)} onClick={revoke}>
          {sharing.revoke}
        </button>
      )}
    </li>
  )
}
