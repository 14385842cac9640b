"""Errors as problem+json: the only place that knows which problem has which HTTP status."""

import math
import re
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.routing import iter_route_contexts
from sqlalchemy.exc import SQLAlchemyError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.routing import Mount, compile_path

from treestroke.api.following import TooManyFollowers
from treestroke.api.request_counts import RateLimited
from treestroke.api.request_ids import HEADER, request_id
from treestroke.core.errors import TreestrokeError
from treestroke.schemas import Fault, Problem
from treestroke.service.deliveries import Disabled
from treestroke.service.failures import code_of, problem_of
from treestroke.service.keys import Exceeded
from treestroke.service.members import LastOwner
from treestroke.service.photos import NotFound
from treestroke.service.quotas import MODELS_A_DAY, QUEUED, STORED, STREAMS, QuotaExceeded, stored_full
from treestroke.service.shares import ShareOver, Unfinished
from treestroke.service.stored_models import KeyReused
from treestroke.service.tracer import NoRoom
from treestroke.service.tracing_pool import CannotStart, Crashed, Overloaded
from treestroke.service.webhooks import MOST_WEBHOOKS, TooManyWebhooks
from treestroke.store.objects import Damaged
from treestroke.store.queries import NotYours
from treestroke.store.uploads import Superseded, WrongOffset

MEDIA_TYPE = "application/problem+json"
_RETRY_SECONDS = 1
_RETRY_HEADER = {"Retry-After": {"schema": {"type": "string", "pattern": "^[0-9]+$"}, "description": "seconds"}}
_RETRY_STATUS = (HTTPStatus.SERVICE_UNAVAILABLE, HTTPStatus.TOO_MANY_REQUESTS)
_STATUS = {
    "bad_request": 400,
    "malformed_json": 400,
    "unauthenticated": 401,
    "scope_missing": 403,
    "role_missing": 403,
    "read_only": 403,
    "not_hosted": 403,
    "foreign_host": 403,
    "foreign_origin": 403,
    "not_yours": 403,
    "not_found": 404,
    "photo_not_found": 404,
    "model_not_found": 404,
    "capture_not_found": 404,
    "clip_not_found": 404,
    "upload_not_found": 404,
    "key_not_found": 404,
    "member_not_found": 404,
    "team_not_found": 404,
    "share_not_found": 404,
    "webhook_not_found": 404,
    "delivery_not_found": 404,
    "frame_not_found": 404,
    "file_not_found": 404,
    "method_not_allowed": 405,
    "body_too_slow": 408,
    "request_too_slow": 408,
    "capture_unsolved": 409,
    "model_unfinished": 409,
    "upload_offset_wrong": 409,
    "upload_superseded": 409,
    "last_owner": 409,
    "webhook_disabled": 409,
    "too_many_webhooks": 409,
    "share_revoked": 410,
    "share_expired": 410,
    "body_too_large": 413,
    "unsupported_media_type": 415,
    "range_not_satisfiable": 416,
    "invalid": 422,
    "idempotency_key_reused": 422,
    "webhook_address": 422,
    "rate_limited": 429,
    "quota_exceeded": 429,
    "queue_full": 429,
    "text_unusable": 422,
    "internal": 500,
    "file_damaged": 500,
    "overloaded": 503,
    "tracing_stopped": 503,
    "tracing_unavailable": 503,
    "photos_full": 507,
    "storage_full": 507,
    "storage_read_only": 500,
    "storage_broken": 500,
    "storage_unavailable": 503,
    "file_missing": 500,
    "too_many_files": 503,
    "database_busy": 503,
    "database_unavailable": 503,
}
"""HTTP status of each problem's code; the codes of a `TreestrokeError` that are not listed have `_INPUT_STATUS`."""
_INPUT_STATUS = 422
_EXCEEDED = {
    STORED: "the team's photos, clips and files would take more than they may; delete some, and ask again a day later",
    QUEUED: "as many models and captures of the team wait as may wait; ask again when one is finished",
    MODELS_A_DAY: "the team has asked for as many models in 24 hours as it may; ask again later",
    STREAMS: "as many streams of events are open as one person may have; close one, or ask for the model now and then",
}
"""What is said of each quota."""
BODY = ("bad_request", "body_too_slow", "body_too_large", "unsupported_media_type", "invalid")
"""Codes that every route which reads a body may answer with, for `documented`."""
log = structlog.get_logger()


class Refusal(HTTPException):
    """A request that a route or a middleware refuses; ``code`` decides the HTTP status."""

    def __init__(self, code: str, detail: str, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(_STATUS[code], detail, headers)
        self.code = code


def problem(
    code: str, detail: str, errors: Sequence[Fault] = (), headers: Mapping[str, str] | None = None
) -> JSONResponse:
    """Return the response to a problem; where it is over before long, the response says when to try again."""
    return _response(_STATUS.get(code, _INPUT_STATUS), code, detail, errors, headers)


def _response(
    status: int, code: str, detail: str, errors: Sequence[Fault] = (), headers: Mapping[str, str] | None = None
) -> JSONResponse:
    id = request_id()
    headers = {**(headers or {}), HEADER: id}
    if status == HTTPStatus.SERVICE_UNAVAILABLE:
        headers["Retry-After"] = str(_RETRY_SECONDS)
    if status == HTTPStatus.UNAUTHORIZED:
        headers["WWW-Authenticate"] = "Bearer"
    body = Problem(
        type="about:blank",
        title=HTTPStatus(status).phrase,
        status=status,
        detail=detail,
        code=code,
        errors=list(errors),
        request_id=id,
    )
    return JSONResponse(body.model_dump(), status, headers, MEDIA_TYPE)


def documented(*codes: str) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses for the problems with these codes, by status."""
    content = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    described: dict[int | str, dict[str, Any]] = {}
    for status in sorted({_STATUS[code] for code in codes}):
        described[status] = {"description": HTTPStatus(status).phrase, "content": content}
        if status in _RETRY_STATUS:
            described[status]["headers"] = _RETRY_HEADER
    return described


def add_handlers(app: FastAPI) -> None:
    """Respond to every error with a problem."""
    for kind, answer in _ANSWERS.items():
        app.add_exception_handler(kind, answer)


def _input(_: Request, error: TreestrokeError) -> JSONResponse:
    faults = [Fault(pointer=error.pointer, code=error.code, detail=str(error))] if error.pointer else []
    return problem(error.code, str(error), faults)


def _invalid(_: Request, error: RequestValidationError) -> JSONResponse:
    if error.errors()[0]["type"] == "json_invalid":
        return problem("malformed_json", "the body is not valid JSON; send it again")
    # What was sent is not repeated in the response: it may be anything.
    faults = [
        Fault(pointer="".join(f"/{part}" for part in found["loc"][1:]), code=found["type"], detail=found["msg"])
        for found in error.errors()
    ]
    said = "; ".join(f"{fault.pointer[1:]}: {fault.detail}" for fault in faults)
    return problem("invalid", f"{said}; change it", faults)


def _missing(_: Request, error: NotFound) -> JSONResponse:
    return problem(f"{error}_not_found", f"there is no such {error}; check its id")


def _not_yours(_: Request, __: NotYours) -> JSONResponse:
    return problem("not_yours", "somebody else made this; ask them, or an owner of the team, to do it")


def _unfinished(_: Request, __: Unfinished) -> JSONResponse:
    return problem("model_unfinished", "this model has no tree that could be shared; wait for it, or grow it again")


def _share_over(_: Request, error: ShareOver) -> JSONResponse:
    how = "was revoked" if error.code == "share_revoked" else "has ended"
    return problem(error.code, f"this link {how}; ask who sent it for another one")


def _reused(_: Request, __: KeyReused) -> JSONResponse:
    detail = "this Idempotency-Key was used with another request; take a new one"
    return problem("idempotency_key_reused", detail)


def _last_owner(_: Request, __: LastOwner) -> JSONResponse:
    return problem("last_owner", "this is the team's only owner; make another member owner first")


def _webhook_disabled(_: Request, __: Disabled) -> JSONResponse:
    return problem("webhook_disabled", "this webhook is disabled, so that nothing is sent to it; enable it first")


def _too_many_webhooks(_: Request, __: TooManyWebhooks) -> JSONResponse:
    return problem("too_many_webhooks", f"a team has at most {MOST_WEBHOOKS} webhooks; remove one first")


def _beyond_scopes(_: Request, error: Exceeded) -> JSONResponse:
    return problem("scope_missing", f"your key has not the scope {error}, so it can make none that has; use another")


def _limited(_: Request, error: RateLimited) -> JSONResponse:
    standing = error.standing
    rate, retry_s = standing.rate, str(standing.more_in_s)
    detail = f"{rate.name}: at most {rate.requests} requests in {rate.seconds} s are answered; ask again in {retry_s} s"
    return problem("rate_limited", detail, headers={"Retry-After": retry_s, **standing.headers})


def _quota_exceeded(_: Request, error: QuotaExceeded) -> JSONResponse:
    code = "queue_full" if error.quota == QUEUED else "quota_exceeded"
    headers = {"Retry-After": str(max(math.ceil(error.retry_s), 1))}
    return problem(code, f"{_EXCEEDED[error.quota]} (the limit is {error.limit})", headers=headers)


def _no_room(request: Request, _: NoRoom) -> JSONResponse:
    if limit := request.app.state.resources.quotas.stored_bytes:
        return _quota_exceeded(request, stored_full(limit))
    detail = (
        "all photos and clips together would take more than they may here; delete some, whose room is free a day later"
    )
    return problem("photos_full", f"{detail}, or raise TREESTROKE_PHOTOS_MB")


def _misplaced(_: Request, error: WrongOffset) -> JSONResponse:
    detail = f"{error}; send what follows these, by Upload-Offset: {error.size}"
    return problem("upload_offset_wrong", detail, headers={"Upload-Offset": str(error.size)})


def _superseded(_: Request, __: Superseded) -> JSONResponse:
    return problem("upload_superseded", "another request goes on with this upload; ask by HEAD how far it is")


def _busy(_: Request, error: Overloaded) -> JSONResponse:
    return problem("overloaded", f"{error}; try again")


def _crowded(_: Request, __: TooManyFollowers) -> JSONResponse:
    return problem("overloaded", "too much is followed at the moment; try again")


def _crashed(_: Request, error: Crashed) -> JSONResponse:
    log.error("tracer_replaced", why=str(error))
    detail = "this took too long or failed; try again, or with fewer strokes"
    return problem("tracing_stopped", detail)


def _cannot_start(_: Request, error: CannotStart) -> JSONResponse:
    log.error("tracer_not_started", why=str(error))
    detail = f"the process that reads this cannot be started ({error}); try again"
    return problem("tracing_unavailable", detail)


def _storage(request: Request, error: OSError | SQLAlchemyError) -> JSONResponse:
    code = code_of(error)
    if code not in _STATUS:
        return _ours(request, error)
    log.error("storage_failed", code=code, error=str(getattr(error, "orig", error)))
    return problem(code, problem_of(code)["detail"])


def _damaged(_: Request, error: Damaged) -> JSONResponse:
    log.error("file_damaged", file=str(error))
    detail = "a file that the service kept is damaged or gone; upload it again, or ask for its model or cameras again"
    return problem("file_damaged", f"{detail}, and have `treestroke doctor` say what else is")


def _http(request: Request, error: HTTPException) -> JSONResponse:
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        return nothing_there(request.method, allowed_methods(request.app, request.scope["path"]))
    if error.detail == HTTPStatus.NOT_FOUND.phrase:
        return nothing_there(request.method, ())
    code = next((code for code, status in _STATUS.items() if status == error.status_code), "error")
    return _response(error.status_code, code, str(error.detail), headers=error.headers)


def _refused(_: Request, error: Refusal) -> JSONResponse:
    return problem(error.code, error.detail, headers=error.headers)


def _gone(_: Request, __: ClientDisconnect) -> JSONResponse:
    """Respond to a client that left before its body was whole, though nobody reads it."""
    return problem("bad_request", "the body ended too soon; send it again")


def _ours(_: Request, error: Exception) -> JSONResponse:
    log.error("request_failed", exc_info=error)
    return problem("internal", f"this is our mistake; try again later. The log has more by request_id {request_id()}")


_ANSWERS: dict[type[Exception], Any] = {
    TreestrokeError: _input,
    RequestValidationError: _invalid,
    NotFound: _missing,
    NotYours: _not_yours,
    Unfinished: _unfinished,
    ShareOver: _share_over,
    KeyReused: _reused,
    LastOwner: _last_owner,
    Disabled: _webhook_disabled,
    TooManyWebhooks: _too_many_webhooks,
    Exceeded: _beyond_scopes,
    NoRoom: _no_room,
    RateLimited: _limited,
    QuotaExceeded: _quota_exceeded,
    WrongOffset: _misplaced,
    Superseded: _superseded,
    Overloaded: _busy,
    TooManyFollowers: _crowded,
    Crashed: _crashed,
    CannotStart: _cannot_start,
    Damaged: _damaged,
    OSError: _storage,
    SQLAlchemyError: _storage,
    Refusal: _refused,
    HTTPException: _http,
    ClientDisconnect: _gone,
    Exception: _ours,
}


def nothing_there(method: str, allowed: Sequence[str]) -> JSONResponse:
    """Return a 405 that names the ``allowed`` methods of an address, or a 404 where there are none."""
    if not allowed:
        nothing = "there is nothing at this address; /openapi.json names what there is"
        return problem("not_found", nothing)
    names = ", ".join(allowed)
    return problem("method_not_allowed", f"{method} does nothing here; what does is {names}", headers={"Allow": names})


def allowed_methods(app: FastAPI, path: str) -> list[str]:
    """Return the methods of all routes at a path; empty where there is nothing."""
    methods: set[str] = set()
    for route in iter_route_contexts(app.routes):
        if isinstance(route.original_route, Mount) and path.startswith(f"{route.path}/"):
            methods.add("GET")
        elif route.path and re.fullmatch(compile_path(route.path)[0], path):
            methods |= set(route.methods or ())
    methods |= {"HEAD"} if "GET" in methods else set()
    return sorted(methods | {"OPTIONS"}) if methods else []
