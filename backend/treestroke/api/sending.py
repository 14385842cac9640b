"""Stored files as answers: whole, in part, or not again."""

import re
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import Request, Response
from fastapi.responses import FileResponse
from starlette.datastructures import MutableHeaders

from treestroke.api.errors import documented, problem
from treestroke.service.photos import Shelf

_TAG_HEADER = {"ETag": {"schema": {"type": "string"}, "description": "SHA-256 of the file, in quotes"}}
_RANGE = re.compile(r"bytes=(?:(\d{1,18})-(\d{0,18})|-(\d{1,18}))")


def file_responses(kind: str, schema: str = "") -> dict[int | str, dict[str, Any]]:
    """Name the answers of a route that sends a file, JSON perhaps of a ``schema``, for the API's document."""
    content: dict[str, Any] = {"content": {kind: {"schema": {"type": "string", "format": "binary"}}}}
    whole = {"content": {kind: {"schema": {"$ref": f"#/components/schemas/{schema}"}}}} if schema else content
    length = {"Content-Range": {"schema": {"type": "string"}, "description": "bytes FIRST-LAST/ALL"}}
    problems = documented("foreign_host", "not_found", "range_not_satisfiable", "internal")
    problems[HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE]["headers"] = length
    return {
        HTTPStatus.OK: {**whole, "description": "The file", "headers": _TAG_HEADER},
        HTTPStatus.PARTIAL_CONTENT: {
            **content,
            "description": "The part that Range asks for",
            "headers": {**_TAG_HEADER, **length},
        },
        HTTPStatus.NOT_MODIFIED: {"description": "If-None-Match names this very file", "headers": _TAG_HEADER},
        **problems,
    }


def send_blob(request: Request, shelf: Shelf, blob: str, kind: str, download: str | None = None) -> Response:
    """Send a blob, which is named by its SHA-256, as `send_file` does.

    Raises
    ------
    Damaged
        The file is not what it was: neither it nor its ETag is told.
    """
    return send_file(request, shelf.blobs.check(blob), blob, kind, download)


def send_file(request: Request, path: Path, sha256: str, kind: str, download: str | None = None) -> Response:
    """Send a file; its SHA-256 is its ETag. One range is honoured, whatever else Range says is passed over."""
    tag = f'"{sha256}"'
    headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
    if _names(request.headers.get("if-none-match", ""), tag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    size = path.stat().st_size
    part = _part(request, tag, size)
    if part is None:
        del MutableHeaders(scope=request.scope)["range"]
    elif not part:
        told = {"Content-Range": f"bytes */{size}"}
        return problem("range_not_satisfiable", f"the file has {size} bytes; ask for some of them", headers=told)
    if download is not None:
        headers["Content-Disposition"] = _saved_as(download)
    return FileResponse(path, headers=headers, media_type=kind)


def _saved_as(name: str) -> str:
    """Propose a name for a download, in ASCII, too, for clients that know nothing else (RFC 6266, appendix D)."""
    name = re.sub(r'[\\/:*?"<>|]', "_", name)
    plain = re.sub(r"[^ -~]", "_", name)
    also = "" if plain == name else f"; filename*=UTF-8''{quote(name, safe='')}"
    return f'attachment; filename="{plain}"{also}'


def _names(known: str, tag: str) -> bool:
    """Tell whether If-None-Match names a file (a weak comparison, RFC 9110, 13.1.2)."""
    return known.strip() == "*" or tag in re.findall(r'"[^"]*"', known)


def _part(request: Request, tag: str, size: int) -> range | None:
    """Read which bytes are asked for, perhaps none that there are; None for all."""
    found = _RANGE.fullmatch(request.headers.get("range", ""))
    if found is None or request.headers.get("if-range", tag) != tag:
        return None
    first, last, ending = found.groups()
    if ending:
        return range(size)[-int(ending) :] if int(ending) else range(0)
    if last and int(last) < int(first):
        return None
    return range(size)[int(first) : int(last) + 1 if last else size]
