"""The web application."""

import re
import sys
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from http import HTTPStatus
from typing import Any

from fastapi import Depends, FastAPI
from fastapi.routing import APIRoute
from pydantic.json_schema import models_json_schema
from starlette.types import ASGIApp, Scope
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from treestroke import __version__
from treestroke.api.errors import add_handlers, documented
from treestroke.api.following import Watcher
from treestroke.api.identity import SECURITY_SCHEMES, admit
from treestroke.api.issuer import Issuer
from treestroke.api.metrics import add_metrics, private_metrics
from treestroke.api.middleware import BodyLimitMiddleware, MethodMiddleware, SecurityMiddleware, is_streamed
from treestroke.api.rates import RateHeadersMiddleware, limit_rate, limit_uploads
from treestroke.api.request_counts import RequestCounts
from treestroke.api.request_ids import RequestIdMiddleware
from treestroke.api.routes import (
    audit,
    captures,
    clips,
    events,
    files,
    keys,
    models,
    oidc,
    photos,
    session,
    shared,
    shares,
    sketches,
    status,
    team,
    uploads,
    webhooks,
)
from treestroke.api.routes.page import add_page
from treestroke.api.rules import RULES
from treestroke.api.shared_redis import SharedRedis
from treestroke.api.sign_ins import FAILED_KEYS, FAILED_SIGN_INS, Failures
from treestroke.api.stream_places import STREAMS_A_PERSON, StreamPlaces
from treestroke.limits import MAX_CLIP_BYTES, MAX_PHOTO_BYTES, MAX_TEXT_BYTES
from treestroke.queue import Hints, make_queue
from treestroke.schemas import Problem
from treestroke.service.accounts import Accounts
from treestroke.service.dispatch import Dispatcher
from treestroke.service.photos import Resources
from treestroke.service.projects import AT_ONCE, Projects
from treestroke.service.quotas import quotas_of
from treestroke.service.tracing_pool import TracingPool
from treestroke.service.webhook_calls import Caller
from treestroke.service.webhook_sender import WebhookSender
from treestroke.settings import Settings
from treestroke.store.blobs import open_blobs
from treestroke.store.data_folder import prepare_folder
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE
from treestroke.store.upload_pieces import open_uploads
from treestroke.wire_accounts import KeyRequest, MemberChange, MemberRequest, SignIn, TeamChange
from treestroke.wire_edits import Edits
from treestroke.wire_requests import (
    CaptureRequest,
    CaptureTraceRequest,
    ClipTraceRequest,
    ModelChange,
    ModelRequest,
    Rename,
    ShareRequest,
    SiblingsRequest,
    SketchTraceRequest,
    TraceRequest,
)
from treestroke.wire_strokes import Strokes
from treestroke.wire_webhooks import WebhookChange, WebhookRequest

HOSTS = ("127.0.0.1", "localhost", "::1")
MAX_FOLLOWERS = 500
CAPTURES_WAITING = 4
"""Captures that are traced or wait for it: one by one, in a process of their own, so that none holds up photos."""
CLIP_TRACERS, CLIPS_WAITING = 2, 8
"""Processes that read and trace clips, so that frames are shown meanwhile; clips and frames that wait or are read."""
_FORM_BYTES = 100_000
"""Most bytes of a form around its file."""
_SMALL_BYTES = 100_000
_CAPTURE_PHOTOS = re.compile(r"/v1/captures/[^/]+/photos")
_ROUTES = (
    *(photos, sketches, captures, clips, uploads, models, events, files, shares, shared),
    *(session, oidc, keys, team, webhooks, audit, status),
)
_ANYWHERE = ("unauthenticated", "foreign_host", "rate_limited", "internal", "overloaded")
"""Codes of problems that every route may answer with."""
_BODIES = (
    Strokes,
    TraceRequest,
    SketchTraceRequest,
    CaptureTraceRequest,
    ClipTraceRequest,
    ModelRequest,
    Edits,
    Rename,
    ModelChange,
    ShareRequest,
    SiblingsRequest,
    CaptureRequest,
    SignIn,
    KeyRequest,
    MemberRequest,
    MemberChange,
    TeamChange,
    WebhookRequest,
    WebhookChange,
    Problem,
)
"""What bodies hold that FastAPI does not read."""
_REF = "#/components/schemas/{model}"


class _App(FastAPI):
    """An application whose requests have an id before all else, and come from whom a trusted proxy says."""

    def build_middleware_stack(self) -> ASGIApp:
        proxied = ProxyHeadersMiddleware(super().build_middleware_stack(), self.state.settings.trusted_proxies)  # type: ignore[arg-type]
        return RequestIdMiddleware(proxied, proxied.trusted_hosts)  # type: ignore[arg-type]


def make_app(settings: Settings, places: int = MAX_FOLLOWERS) -> FastAPI:
    """Return the application; it opens database, queue and tracing processes when it starts.

    At most ``places`` requests may follow models and captures at once.
    """
    app = _App(
        title="treestroke",
        version=__version__,
        summary="One photo of a tree and a few strokes, several photos of it, or two sketches, become a 3D tree.",
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=_operation_id,
        dependencies=[Depends(admit)],
    )
    app.state.settings, app.state.places = settings, places
    app.state.uploads = Counter()
    add_handlers(app)
    counted = [Depends(limit_rate), Depends(limit_uploads)] if settings.hosted else []
    for routes in _ROUTES:
        app.include_router(routes.router, responses=documented(*_ANYWHERE), dependencies=counted)
    add_metrics(app, settings.hosted)
    add_page(app)
    if settings.hosted:
        app.add_middleware(RateHeadersMiddleware)
    app.add_middleware(BodyLimitMiddleware, limit_of=_limit_of)
    app.add_middleware(MethodMiddleware)
    app.add_middleware(SecurityMiddleware, hosts={*HOSTS, *settings.host_names}, hosted=settings.hosted)
    app.openapi = partial(_document, app)  # type: ignore[method-assign]
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    settings: Settings = app.state.settings
    prepare_folder(settings.folder)
    database = Database(settings.folder, settings.database_url, settings.owner_database_url)
    database.check()
    database.migrate()
    blobs = open_blobs(database, settings.folder, settings.bucket_url)
    tracers = TracingPool(settings.tracers, settings.trace_seconds, settings.memory_mb)
    capture_tracers = TracingPool(1, settings.capture_trace_seconds, settings.memory_mb, CAPTURES_WAITING)
    clip_tracers = TracingPool(CLIP_TRACERS, settings.capture_trace_seconds, settings.memory_mb, CLIPS_WAITING)
    dispatcher = Dispatcher(
        database.of(SERVICE), blobs, Hints(make_queue(settings)), settings.keep_days, settings.most_running
    )
    limits = settings.photo_mb * 10**6, sys.maxsize if settings.hosted else settings.photos_mb * 10**6
    app.state.resources = Resources(
        database,
        blobs,
        tracers,
        capture_tracers,
        clip_tracers,
        open_uploads(database, blobs),
        *limits,
        quotas_of(settings),
    )
    _set_up_identity(app, database)
    packers = TracingPool(AT_ONCE, settings.capture_trace_seconds, settings.memory_mb)
    app.state.projects = Projects(blobs, packers)
    app.state.dispatcher = dispatcher
    tracers.start()
    streams = StreamPlaces(app.state.redis, STREAMS_A_PERSON if settings.hosted else 0)
    app.state.watcher = Watcher(database.of(SERVICE), app.state.places, streams)
    dispatcher.start()
    _set_up_webhooks(app, database)
    try:
        with private_metrics(settings):
            yield
    finally:
        app.state.webhook_sender.stop()
        dispatcher.stop()
        packers.close()
        await app.state.redis.close()
        if app.state.issuer:
            await app.state.issuer.close()
        app.state.projects.close()
        tracers.close()
        capture_tracers.close()
        clip_tracers.close()
        database.close()


def _set_up_identity(app: FastAPI, database: Database) -> None:
    """Prepare what tells who asks, and counts how often they do."""
    settings: Settings = app.state.settings
    app.state.accounts = Accounts.of(database, settings.secret)
    app.state.redis = SharedRedis(settings.broker_url)
    app.state.counts = RequestCounts(app.state.redis)
    app.state.failed_sign_ins = Failures(app.state.counts, FAILED_SIGN_INS)
    app.state.failed_keys = Failures(app.state.counts, FAILED_KEYS)
    app.state.issuer = Issuer(settings) if settings.oidc_issuer else None


def _set_up_webhooks(app: FastAPI, database: Database) -> None:
    """Prepare what tells addresses of teams about their jobs; where there are teams, it begins."""
    settings: Settings = app.state.settings
    app.state.webhook_caller = Caller()
    app.state.webhook_sender = WebhookSender(database.of(SERVICE), settings.secret, app.state.webhook_caller)
    if settings.hosted:
        app.state.webhook_sender.start()


def _limit_of(scope: Scope) -> int:
    """Return how many bytes a request's body may have."""
    path = scope["path"]
    if is_streamed(scope):
        return MAX_CLIP_BYTES + _FORM_BYTES
    if path == "/v1/photos" or _CAPTURE_PHOTOS.fullmatch(path):
        return MAX_PHOTO_BYTES + _FORM_BYTES
    if path == "/v1/models":
        return MAX_PHOTO_BYTES + MAX_TEXT_BYTES
    return MAX_TEXT_BYTES if path.endswith("/trace") else _SMALL_BYTES


def _operation_id(route: APIRoute) -> str:
    return route.name


def _drop_standard_problems(document: dict[str, Any]) -> None:
    """Remove FastAPI's own form of an invalid request, which it adds wherever a parameter exists; ours are listed."""
    invalid = str(HTTPStatus.UNPROCESSABLE_ENTITY.value)
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    for operation in (operation for path in document["paths"].values() for operation in path.values()):
        if "HTTPValidationError" in str(operation["responses"].get(invalid)):
            del operation["responses"][invalid]


def _name_security(document: dict[str, Any], hosted: bool) -> None:
    """Say how one is known, and where that is asked: nowhere in a service without keys."""
    document["components"]["securitySchemes"] = SECURITY_SCHEMES
    if not hosted:
        return
    known: list[dict[str, list[str]]] = [{name: []} for name in SECURITY_SCHEMES]
    for operation in (operation for path in document["paths"].values() for operation in path.values()):
        operation["security"] = [] if RULES[operation["operationId"]] is None else known


def _document(app: FastAPI) -> dict[str, Any]:
    """Return the API's document, with the bodies that tracing processes read in place of FastAPI."""
    known = app.openapi_schema is not None
    document: dict[str, Any] = FastAPI.openapi(app)
    if not known:
        schemas = document["components"]["schemas"]
        _, extra = models_json_schema(
            [(model, "validation") for model in _BODIES],
            ref_template=_REF,
        )
        schemas.update(extra["$defs"])
        _drop_standard_problems(document)
        _name_security(document, app.state.settings.hosted)
    return document
