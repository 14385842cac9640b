import '../ui/parts/base.css'
import { render } from 'preact'
import { SharePage } from './SharePage'
import { linkOf } from './sharedTree'

const isEmbedded = new URLSearchParams(location.search).has('embed')
render(<SharePage link={linkOf(location)} embedded={isEmbedded} />, document.body)
