import { json, request } from './request'
import type { components } from './schema'
import type { Delivery, MadeWebhook, Webhook, WebhookChange, WebhookOrder } from './types'

type Schemas = components['schemas']

/** The page's calls about webhooks; each may throw `Refused` or `Unreachable`. */
class Webhooks {
  async list(): Promise<readonly Webhook[]> {
    return (await request<Schemas['WebhookList']>('GET', '/v1/webhooks')).webhooks
  }

  /** Make a webhook; the answer alone has its secret. */
  make(order: WebhookOrder): Promise<MadeWebhook> {
    return request('POST', '/v1/webhooks', json(order))
  }

  change(id: string, change: WebhookChange): Promise<MadeWebhook> {
    return request('PATCH', `/v1/webhooks/${id}`, json(change))
  }

  remove(id: string): Promise<void> {
    return request('DELETE', `/v1/webhooks/${id}`)
  }

  ping(id: string): Promise<Delivery> {
    return request('POST', `/v1/webhooks/${id}/ping`)
  }

  /** Return a page of the messages to a webhook, newest first. */
  deliveries(id: string, cursor: string | null = null): Promise<Schemas['DeliveryList']> {
    return request('GET', `/v1/webhooks/${id}/deliveries${cursor === null ? '' : `?cursor=${cursor}`}`)
  }

  resend(id: string): Promise<Delivery> {
    return request('POST', `/v1/deliveries/${id}/resend`)
  }
}

export const webhooks = new Webhooks()
