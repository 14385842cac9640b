import './ui/parts/base.css'
import { render } from 'preact'
import { Studio } from './studio/studio'
import { App } from './ui/App'
import { followTitle } from './ui/start/title'
import { warnUnkept, warnUnopened } from './ui/start/warnings'

const studio = new Studio()
const { store, client, session } = studio

render(<App studio={studio} />, document.body)
followTitle(store)
warnUnkept(studio)
warnUnopened(studio)
void session.find()
client.getLimits().then(
  limits => store.set({ limits }),
  () => {}, // the service tells its limits again when one is passed
)
