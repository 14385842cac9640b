"""Shares: links by which anybody sees a model, until they end or are revoked."""

import hashlib
import secrets
import time
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import select

from treestroke.codec.refusals import checked
from treestroke.core.errors import TreestrokeError
from treestroke.service import tracer
from treestroke.service.jobs import GLB
from treestroke.service.model_request import read_body
from treestroke.service.photos import NotFound, Resources
from treestroke.service.stored_models import StoredModel, find_model
from treestroke.store.audit import record
from treestroke.store.queries import check_removable, new_id
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import Share
from treestroke.wire_requests import ShareRequest

TOKEN_BYTES = 16
_READER = "share"
"""Who reads a model by a link: nobody that makes anything."""
_LISTED = 100
"""Most links of a model that are listed, the newest."""
_PHOTO_PX = 1600
"""Longest side of the photo as a link shows it."""
_DAY = 86_400.0


class Unfinished(Exception):
    """A model without a tree was about to be shared."""


class ShareOver(Exception):
    """A link was revoked, or its time is over: ``code`` tells which."""

    def __init__(self, code: str) -> None:
        super().__init__(code)
        self.code = code


@dataclass(frozen=True)
class Shared:
    """What a link leads to: the model, and the service's parts with the rows of its team alone."""

    share: Share
    model: StoredModel
    resources: Resources


def make_share(resources: Resources, id: str, body: bytes) -> tuple[Share, str]:
    """Make a link to a model by the body of a request; return its row and its token, which nothing else tells.

    Raises
    ------
    NotFound, TreestrokeError
        There is no such model; it is not such a request.
    Unfinished
        The model has no tree.
    """
    asked = checked(ShareRequest, read_body(body), TreestrokeError)
    model = find_model(resources.database, id)
    if model.row.status != "succeeded" or GLB not in model.files:
        raise Unfinished
    token, now = secrets.token_urlsafe(TOKEN_BYTES), time.time()
    share = Share(
        id=new_id("shr"),
        model=id,
        digest=_digest(token),
        photo=asked.photo and "photo" in model.parts,
        download=asked.download,
        created=now,
        expires=now + asked.days * _DAY,
    )
    with resources.database.writing() as session:
        session.add(share)
        record(session, "share.made", share.id, model=id, photo=share.photo, download=share.download)
    return share, token


def list_shares(resources: Resources, id: str) -> Sequence[Share]:
    """Return the links to a model, newest first.

    Raises
    ------
    NotFound
        There is no such model.
    """
    find_model(resources.database, id)
    with resources.database.reading() as session:
        newest = select(Share).where(Share.model == id).order_by(Share.number.desc())
        return session.scalars(newest.limit(_LISTED)).all()


def revoke_share(resources: Resources, id: str) -> None:
    """End a link at once; one that was revoked stays so.

    Raises
    ------
    NotFound, NotYours
        There is no such link, or it may not be revoked by whom the session is for.
    """
    with resources.database.writing() as session:
        share = session.scalars(select(Share).where(Share.id == id)).first()
        if share is None:
            raise NotFound("share")
        check_removable(session, share)
        if share.revoked is None:
            share.revoked = time.time()
            record(session, "share.revoked", id, model=share.model)


def open_share(resources: Resources, token: str) -> Shared:
    """Find what a link leads to, in whatever team.

    Raises
    ------
    NotFound
        There is no such link, or its model was deleted.
    ShareOver
        It was revoked, or its time is over.
    """
    with resources.of(SERVICE).database.reading() as session:
        share = session.scalars(select(Share).where(Share.digest == _digest(token))).first()
    if share is None:
        raise NotFound("share")
    if share.revoked is not None:
        raise ShareOver("share_revoked")
    if share.expires <= time.time():
        raise ShareOver("share_expired")
    own = resources.of(Scope(share.team, _READER, "none"))
    try:
        return Shared(share, find_model(own.database, share.model), own)
    except NotFound:
        raise NotFound("share") from None


def photo_of(shared: Shared) -> bytes:
    """Return the photo of a shared model as a JPEG.

    Raises
    ------
    NotFound
        The link shows no photo.
    Damaged, Overloaded
        The photo's file is damaged, or too much is traced at the moment.
    """
    if not shared.share.photo:
        raise NotFound("file")
    resources, blob = shared.resources, shared.model.parts["photo"].blob
    return resources.tracers(blob, tracer.photo_jpeg, resources.blobs.path(blob), _PHOTO_PX)


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
