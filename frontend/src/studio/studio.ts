import { Client } from '../api/client'
import { Store } from '../state'
import { Desk } from './desk'
import { Grower } from './grower'
import { Herbarium } from './herbarium'
import { Keeper } from './keeper'
import { Opener } from './opener'
import { Sketchbook } from './sketchbook'
import { Tracer } from './tracer'

/** Everything that can be done on the page, apart from how it looks. */
export class Studio {
  readonly store = new Store()
  readonly client = new Client()
  readonly keeper = new Keeper(this.store)
  readonly sketchbook = new Sketchbook(this.store)
  readonly desk = new Desk(this.store, this.client)
  readonly herbarium = new Herbarium(this.store)
  readonly grower = new Grower(this.store, this.client)
  readonly opener = new Opener(this.store, this.client, this.keeper, this.grower)
  readonly tracer = new Tracer(this.store, this.client)
}
