import { Accounts } from '../api/accounts'
import { Client } from '../api/client'
import { Playhead } from '../playhead'
import { Store } from '../state'
import { Captures } from './captures'
import { Clips } from './clips'
import { DraftStore } from './draftStore'
import { BranchEdits } from './edits'
import { Grower } from './grower'
import { Opener } from './opener'
import { OwnPictureActions } from './ownPictures'
import { SessionActions } from './session'
import { SheetActions } from './sheetActions'
import { StrokeActions } from './strokeActions'
import { TakenActions } from './takenActions'
import { Thumbnails } from './thumbnails'
import { Tracer } from './tracer'

/** Everything that can be done on the page, apart from how it looks. */
export class Studio {
  readonly store = new Store()
  readonly playhead = new Playhead()
  readonly client = new Client()
  readonly drafts = new DraftStore(this.store)
  readonly strokes = new StrokeActions(this.store)
  readonly edits = new BranchEdits(this.store, this.strokes)
  readonly sheets = new SheetActions(this.store, this.client)
  readonly ownPictures = new OwnPictureActions(this.store)
  readonly grower = new Grower(this.store, this.client)
  readonly taken = new TakenActions(this.store, this.grower)
  readonly thumbnails = new Thumbnails(this.client, this.drafts)
  readonly captures = new Captures(this.store, this.client, this.thumbnails)
  readonly clips = new Clips(this.store, this.client, this.thumbnails)
  readonly opener = new Opener(this.store, this.client, this.drafts, this.grower, this.captures, this.clips)
  readonly accounts = new Accounts()
  readonly session = new SessionActions(this.store, this.accounts, () => {
    this.opener.close()
    location.reload()
  })
  readonly tracer = new Tracer(this.store, this.client)
}
