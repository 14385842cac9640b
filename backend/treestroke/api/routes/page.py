"""The browser's page: files that Vite built from frontend/ into the package."""

from http import HTTPStatus
from os import PathLike, fspath, stat_result
from pathlib import Path, PurePath

from fastapi import FastAPI, Request, Response
from fastapi.responses import FileResponse, PlainTextResponse
from fastapi.staticfiles import StaticFiles
from starlette.types import Scope

from treestroke.api.middleware import POLICY

PAGE = Path(__file__).parents[1] / "page"
_FOREVER = "public, max-age=31536000, immutable"
_ASK_FIRST = "no-cache"
_NOT_BUILT = """\
The page is not built here. In treestroke's source folder run

    make page

and load this again. The API answers as it is: see /openapi.json.
"""
_POLICY = f"{POLICY}; script-src 'self' 'wasm-unsafe-eval'"
"""The page's own: what unpacks compressed trees is WebAssembly."""
# What a system's own table says may be wrong or missing, and browsers are told to believe us.
_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".glb": "model/gltf-binary",
    ".html": "text/html; charset=utf-8",
    ".jpg": "image/jpeg",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".webp": "image/webp",
}


class BuiltPage(StaticFiles):
    """The page's files; none of them where it was not built.

    Files below ``assets`` have a hash of their content in their name and are kept for ever; a browser asks anew for
    the others.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, html=True, check_dir=False)
        self.config_checked = True  # a missing folder is no fault
        self._assets = folder.resolve() / "assets"
        self.index = folder / "index.html"
        self.icon = folder / "favicon.svg"

    def file_response(
        self, full_path: str | PathLike[str], stat_result: stat_result, scope: Scope, status_code: int = HTTPStatus.OK
    ) -> Response:
        """Answer with a file, its type and how long it may be kept."""
        response = super().file_response(full_path, stat_result, scope, status_code)
        path = PurePath(fspath(full_path))
        response.headers["cache-control"] = _FOREVER if self._assets in path.parents else _ASK_FIRST
        if response.status_code != HTTPStatus.NOT_MODIFIED and path.suffix in _TYPES:
            response.headers["content-type"] = _TYPES[path.suffix]
        return response


def add_page(app: FastAPI, folder: Path = PAGE) -> None:
    """Serve the page at ``/`` and its files below ``/page``."""
    built = BuiltPage(folder)

    @app.get("/", include_in_schema=False)
    async def page(request: Request) -> Response:
        if not built.index.is_file():
            return PlainTextResponse(_NOT_BUILT, HTTPStatus.NOT_FOUND)
        response = await built.get_response(built.index.name, request.scope)
        response.headers["content-security-policy"] = _POLICY
        return response

    @app.get("/favicon.ico", include_in_schema=False)
    def icon() -> Response:
        if not built.icon.is_file():
            return Response(status_code=HTTPStatus.NO_CONTENT)
        return FileResponse(built.icon, media_type=_TYPES[".svg"], headers={"cache-control": _ASK_FIRST})

    app.mount("/page", built)
