"""Errors as problem+json, and the HTTP status of each error of ours."""

import re
from collections.abc import Sequence
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

from treestroke.api.following import Crowded
from treestroke.core.errors import TreestrokeError
from treestroke.schemas import Fault, Problem
from treestroke.service.failures import code_of, problem_of
from treestroke.service.models import KeyReused
from treestroke.service.photos import NotFound
from treestroke.service.pool import CannotStart, Crashed, Overloaded
from treestroke.service.tracer import NoRoom
from treestroke.store.blobs import Damaged

MEDIA_TYPE = "application/problem+json"
_RETRY = {"Retry-After": "1"}
_RETRY_HEADER = {"Retry-After": {"schema": {"type": "string", "pattern": "^[0-9]+$"}, "description": "seconds"}}
_CODES = {
    400: "bad_request",
    404: "not_found",
    405: "method_not_allowed",
    408: "body_too_slow",
    413: "body_too_large",
    415: "unsupported_media_type",
    503: "overloaded",
}
_STORAGE = {
    "storage_full": 507,
    "storage_read_only": 500,
    "storage_broken": 500,
    "file_missing": 500,
    "too_many_files": 503,
    "database_busy": 503,
    "database_unavailable": 503,
}
log = structlog.get_logger()


def problem(
    status: int, code: str, detail: str, errors: Sequence[Fault] = (), headers: dict[str, str] | None = None
) -> JSONResponse:
    """Return a problem as a response."""
    body = Problem(
        type="about:blank",
        title=HTTPStatus(status).phrase,
        status=status,
        detail=detail,
        code=code,
        errors=list(errors),
    )
    return JSONResponse(body.model_dump(), status, headers, MEDIA_TYPE)


def documented(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the problems that a route may respond with, for the API's document."""
    content = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    described: dict[int | str, dict[str, Any]] = {
        status: {"description": HTTPStatus(status).phrase, "content": content} for status in statuses
    }
    for status in {503} & described.keys():
        described[status]["headers"] = _RETRY_HEADER
    return described


def add_handlers(app: FastAPI) -> None:
    """Respond to every error with a problem."""
    for kind, answer in _ANSWERS.items():
        app.add_exception_handler(kind, answer)


def _input(_: Request, error: TreestrokeError) -> JSONResponse:
    faults = [Fault(pointer=error.pointer, code=error.code, detail=str(error))] if error.pointer else []
    return problem(400 if error.code == "malformed_json" else 422, error.code, str(error), faults)


def _invalid(_: Request, error: RequestValidationError) -> JSONResponse:
    if error.errors()[0]["type"] == "json_invalid":
        return problem(400, "malformed_json", "the body is no valid JSON; send it anew")
    # What was sent is not repeated in the response: it may be anything.
    faults = [
        Fault(pointer="".join(f"/{part}" for part in one["loc"][1:]), code=one["type"], detail=one["msg"])
        for one in error.errors()
    ]
    said = "; ".join(f"{fault.pointer[1:]}: {fault.detail}" for fault in faults)
    return problem(422, "invalid", f"{said}; change it", faults)


def _missing(_: Request, error: NotFound) -> JSONResponse:
    return problem(404, f"{error}_not_found", f"there is no such {error}; check its id")


def _reused(_: Request, __: KeyReused) -> JSONResponse:
    detail = "this Idempotency-Key was used with another request; take a new one"
    return problem(422, "idempotency_key_reused", detail)


def _no_room(_: Request, __: NoRoom) -> JSONResponse:
    detail = "all photos together would take more than they may here; delete some, whose room is free a day later"
    return problem(507, "photos_full", f"{detail}, or raise TREESTROKE_PHOTOS_MB")


def _busy(_: Request, error: Overloaded) -> JSONResponse:
    return problem(503, "overloaded", f"{error}; try again", headers=_RETRY)


def _crowded(_: Request, __: Crowded) -> JSONResponse:
    return problem(503, "overloaded", "too many models are followed at the moment; try again", headers=_RETRY)


def _crashed(_: Request, error: Crashed) -> JSONResponse:
    log.error("tracer_replaced", why=str(error))
    detail = "this took too long or failed; try again, or with fewer strokes"
    return problem(503, "tracing_stopped", detail, headers=_RETRY)


def _cannot_start(_: Request, error: CannotStart) -> JSONResponse:
    log.error("tracer_not_started", why=str(error))
    detail = f"the process that reads this cannot be started ({error}); try again"
    return problem(503, "tracing_unavailable", detail, headers=_RETRY)


def _storage(request: Request, error: OSError | SQLAlchemyError) -> JSONResponse:
    code = code_of(error)
    status = _STORAGE.get(code)
    if status is None:
        return _ours(request, error)
    log.error("storage_failed", code=code, error=str(getattr(error, "orig", error)))
    return problem(status, code, problem_of(code)["detail"], headers=_RETRY if status == 503 else None)


def _damaged(_: Request, error: Damaged) -> JSONResponse:
    log.error("file_damaged", file=str(error))
    detail = "a file that the service kept is damaged or gone; upload the photo or ask for the model again"
    return problem(500, "file_damaged", f"{detail}, and have `treestroke doctor` say what else is")


def _http(request: Request, error: HTTPException) -> JSONResponse:
    if error.status_code == 405:
        return nothing_there(request.method, allowed_methods(request.app, request.scope["path"]))
    if error.detail == HTTPStatus.NOT_FOUND.phrase:
        return nothing_there(request.method, ())
    code = _CODES.get(error.status_code, "error")
    return problem(error.status_code, code, str(error.detail), headers=dict(error.headers or {}))


def _gone(_: Request, __: ClientDisconnect) -> JSONResponse:
    """Respond to a client that left before its body was whole, though nobody reads it."""
    return problem(400, "bad_request", "the body ended too soon; send it again")


def _ours(_: Request, error: Exception) -> JSONResponse:
    log.error("request_failed", exc_info=error)
    return problem(500, "internal", "the service made a mistake, which its log holds; try again later")


_ANSWERS: dict[type[Exception], Any] = {
    TreestrokeError: _input,
    RequestValidationError: _invalid,
    NotFound: _missing,
    KeyReused: _reused,
    NoRoom: _no_room,
    Overloaded: _busy,
    Crowded: _crowded,
    Crashed: _crashed,
    CannotStart: _cannot_start,
    Damaged: _damaged,
    OSError: _storage,
    SQLAlchemyError: _storage,
    HTTPException: _http,
    ClientDisconnect: _gone,
    Exception: _ours,
}


def nothing_there(method: str, allowed: Sequence[str]) -> JSONResponse:
    """Return a 405 that names the ``allowed`` methods of an address, or a 404 where there are none."""
    if not allowed:
        nothing = "there is nothing at this address; /openapi.json names what there is"
        return problem(404, _CODES[404], nothing)
    names = ", ".join(allowed)
    return problem(405, _CODES[405], f"{method} does nothing here; what does is {names}", headers={"Allow": names})


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
