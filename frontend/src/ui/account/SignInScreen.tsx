import type { TargetedEvent } from 'preact'
import { useEffect, useId, useLayoutEffect, useRef, useState } from 'preact/hooks'
import { text } from '../../text'
import { accountText } from '../../text/account'
import { useStore, useStudio } from '../parts/useStore'
import { Illustration } from '../start/Illustration'
import { IssuerSignIn } from './IssuerSignIn'
import './signIn.css'

const { signIn: words } = accountText

/** Lies over the whole page until somebody is signed in: in place of it at first, in front of it where a session has ended. */
export function SignInScreen() {
  const { session, store } = useStudio()
  const when = useStore(state => state.signIn) ?? 'first'
  const title = useId()
  const dialog = useRef<HTMLDialogElement>(null)
  useLayoutEffect(() => {
    const shown = dialog.current!
    shown.showModal()
    return () => shown.close() // which gives the focus back
  }, [])
  useEffect(() => {
    const find = () => void session.find() // another tab may have signed in
    addEventListener('focus', find)
    return () => removeEventListener('focus', find)
  }, [session])
  return (
    <dialog
      class={`sign-in is-${when}`}
      ref={dialog}
      aria-labelledby={title}
      onCancel={event => event.preventDefault()}
      // A second Escape closes a dialog whatever is prevented.
      onClose={({ currentTarget }) => store.state.signIn && currentTarget.isConnected && currentTarget.showModal()}
    >
      <div class="sign-in-card">
        <div class="sign-in-words">
          <p class="sign-in-app">{text.app}</p>
          <h2 id={title}>{words.title[when]}</h2>
          <p class="sign-in-lead">{words.lead[when]}</p>
          <IssuerSignIn isAgain={when === 'again'} />
          <KeyForm />
          <details class="sign-in-more">
            <summary>{words.question}</summary>
            {words.answer.map(sentence => (
              <p key={sentence}>{sentence}</p>
            ))}
          </details>
        </div>
        {when === 'first' && (
          <div class="sign-in-art">
            <Illustration />
          </div>
        )}
      </div>
    </dialog>
  )
}

/** The field for a key, and what is wrong with it. */
function KeyForm() {
  const { session } = useStudio()
  const id = useId()
  const field = useRef<HTMLInputElement>(null)
  const [isSigning, setSigning] = useState(false)
  const [wrong, setWrong] = useState('')
  useLayoutEffect(() => field.current!.focus(), [])
  const sign = async (event: TargetedEvent<HTMLFormElement>) => {
    event.preventDefault()
    if (isSigning) return
    const key = field.current!.value.trim()
    setWrong('')
    setSigning(true)
    const fault = key ? await session.signIn(key) : { text: words.missing }
    setSigning(false)
    if (!fault) return
    setWrong(fault.text)
    field.current?.select()
  }
  return (
    <form class="sign-in-form" onSubmit={sign}>
      <label for={id}>{words.key}</label>
      <input
        id={id}
        class="account-field"
        type="password"
        name="key"
        autocomplete="current-password"
        spellcheck={false}
        placeholder={words.shape}
        aria-invalid={wrong !== ''}
        aria-describedby={`${id}-wrong`}
        ref={field}
      />
      <p class="fault" id={`${id}-wrong`} role="alert" hidden={!wrong}>
        {wrong}
      </p>
      <button type="submit" class="button primary" aria-disabled={isSigning}>
        {isSigning ? words.signing : words.sign}
      </button>
    </form>
  )
}
