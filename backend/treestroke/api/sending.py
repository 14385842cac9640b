"""Stored files as responses: whole, in part, or not modified."""

import re
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import Request, Response
from fastapi.responses import FileResponse
from starlette.datastructures import MutableHeaders

from treestroke.api.errors import documented, problem
from treestroke.service.photos import Resources

_TAG_HEADER = {"ETag": {"schema": {"type": "string"}, "description": "SHA-256 of the file, in quotes"}}
_RANGE = re.compile(r"bytes=(?:(\d{1,18})-(\d{0,18})|-(\d{1,18}))")


def file_responses(kind: str, schema: str = "") -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses of a route that sends a file of media type ``kind``, or JSON of a ``schema``."""
    content: dict[str, Any] = {"content": {kind: {"schema": {"type": "string", "format": "binary"}}}}
    whole = {"content": {kind: {"schema": {"$ref": f"#/components/schemas/{schema}"}}}} if schema else content
    length = {"Content-Range": {"schema": {"type": "string"}, "description": "bytes FIRST-LAST/SIZE"}}
    problems = documented("foreign_host", "not_found", "range_not_satisfiable", "internal")
    problems[HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE]["headers"] = length
    return {
        HTTPStatus.OK: {**whole, "description": "The file", "headers": _TAG_HEADER},
        HTTPStatus.PARTIAL_CONTENT: {
            **content,
            "description": "The part that Range requests",
            "headers": {**_TAG_HEADER, **length},
        },
        HTTPStatus.NOT_MODIFIED: {"description": "If-None-Match has this file's ETag", "headers": _TAG_HEADER},
        **problems,
    }


def send_blob(request: Request, resources: Resources, blob: str, kind: str, download: str | None = None) -> Response:
    """Return a blob as a response, as `send_file` does; its name is its SHA-256.

    Raises
    ------
    Damaged
        The file is missing or has changed.
    """
    return send_file(request, resources.blobs.check(blob), blob, kind, download)


def send_file(request: Request, path: Path, sha256: str, kind: str, download: str | None = None) -> Response:
    """Return a file as a response, with its SHA-256 as ETag; a Range of several parts or of other units is ignored."""
    tag = f'"{sha256}"'
    headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
    if _matches(request.headers.get("if-none-match", ""), tag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    size = path.stat().st_size
    part = _part(request, tag, size)
    if part is None:
        del MutableHeaders(scope=request.scope)["range"]
    elif not part:
        detail = f"the file has {size} bytes; request some of them"
        return problem("range_not_satisfiable", detail, headers={"Content-Range": f"bytes */{size}"})
    if download is not None:
        headers["Content-Disposition"] = _disposition(download)
    return FileResponse(path, headers=headers, media_type=kind)


def _disposition(name: str) -> str:
    """Return a Content-Disposition with a file's name, also in ASCII for old clients (RFC 6266, appendix D)."""
    name = re.sub(r'[\\/:*?"<>|]', "_", name)
    plain = re.sub(r"[^ -~]", "_", name)
    also = "" if plain == name else f"; filename*=UTF-8''{quote(name, safe='')}"
    return f'attachment; filename="{plain}"{also}'


def _matches(if_none_match: str, tag: str) -> bool:
    """Tell whether If-None-Match has an ETag (weak comparison, RFC 9110, section 13.1.2)."""
    return if_none_match.strip() == "*" or tag in re.findall(r'"[^"]*"', if_none_match)


def _part(request: Request, tag: str, size: int) -> range | None:
    """Return the range of requested bytes, empty if it is beyond the file; None for the whole file."""
    found = _RANGE.fullmatch(request.headers.get("range", ""))
    if found is None or request.headers.get("if-range", tag) != tag:
        return None
    first, last, ending = found.groups()
    if ending:
        return range(size)[-int(ending) :] if int(ending) else range(0)
    if last and int(last) < int(first):
        return None
    return range(size)[int(first) : int(last) + 1 if last else size]
