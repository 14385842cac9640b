"""The page: files that Vite builds from frontend/ into the package."""

from http import HTTPStatus
from os import PathLike, fspath, stat_result
from pathlib import Path, PurePath

from fastapi import FastAPI, Request, Response
from fastapi.responses import FileResponse, PlainTextResponse
from fastapi.staticfiles import StaticFiles
from starlette.types import Scope

from treestroke.api.middleware import CONTENT_SECURITY_POLICY

PAGE = Path(__file__).parents[1] / "page"
_CACHE_FOREVER = "public, max-age=31536000, immutable"
_REVALIDATE = "no-cache"
NOT_BUILT = """\
The page has not been built. Run

    make page

in treestroke's source folder and reload. The API works without it: see /openapi.json.
"""
PAGE_POLICY = f"{CONTENT_SECURITY_POLICY}; media-src 'self' blob:; script-src 'self' 'wasm-unsafe-eval'"
"""The page may also run WebAssembly, which decompresses trees."""
# The system's table of media types may be wrong or incomplete, and browsers are told not to guess.
_MEDIA_TYPES = {
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
    """The page's files; empty if the page was not built.

    Files in ``assets`` have a hash of their content in their names, so browsers cache them for ever; they revalidate
    the others.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, html=True, check_dir=False)
        self.config_checked = True  # a missing folder is allowed
        self._assets = folder.resolve() / "assets"
        self.index = folder / "index.html"
        self.icon = folder / "favicon.svg"

    def file_response(
        self, full_path: str | PathLike[str], stat_result: stat_result, scope: Scope, status_code: int = HTTPStatus.OK
    ) -> Response:
        """Return a file as a response with its media type and how long it may be cached."""
        response = super().file_response(full_path, stat_result, scope, status_code)
        path = PurePath(fspath(full_path))
        response.headers["cache-control"] = _CACHE_FOREVER if self._assets in path.parents else _REVALIDATE
        if response.status_code != HTTPStatus.NOT_MODIFIED and path.suffix in _MEDIA_TYPES:
            response.headers["content-type"] = _MEDIA_TYPES[path.suffix]
        return response


def add_page(app: FastAPI, folder: Path = PAGE) -> None:
    """Add routes for the page at ``/`` and its files below ``/page``."""
    built = BuiltPage(folder)

    @app.get("/", include_in_schema=False)
    async def page(request: Request) -> Response:
        if not built.index.is_file():
            return PlainTextResponse(NOT_BUILT, HTTPStatus.NOT_FOUND)
        response = await built.get_response(built.index.name, request.scope)
        response.headers["content-security-policy"] = PAGE_POLICY
        return response

    @app.get("/favicon.ico", include_in_schema=False)
    def icon() -> Response:
        if not built.icon.is_file():
            return Response(status_code=HTTPStatus.NO_CONTENT)
        return FileResponse(built.icon, media_type=_MEDIA_TYPES[".svg"], headers={"cache-control": _REVALIDATE})

    app.mount("/page", built)
