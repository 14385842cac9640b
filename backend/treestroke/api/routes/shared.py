"""What anybody sees of a shared model by its link, without a key: a page, and the files that it shows."""

import html
import re
from http import HTTPStatus
from typing import Annotated
from urllib.parse import urlencode, urlsplit

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.responses import FileResponse, HTMLResponse, PlainTextResponse

from treestroke.api.deps import AllResources
from treestroke.api.errors import documented
from treestroke.api.routes.page import NOT_BUILT, PAGE, PAGE_POLICY
from treestroke.api.sending import file_responses, send_blob
from treestroke.api.views import shared_view
from treestroke.service import shares
from treestroke.service.jobs import GLB, PREVIEW
from treestroke.service.photos import NotFound
from treestroke.service.shares import Shared, ShareOver
from treestroke.share_schemas import OEmbed, SharedModel

router = APIRouter(tags=["shared"])
WIDTH, HEIGHT = 800, 600
"""Size of an embedded tree, px, where a page does not ask for less."""
_TOKEN = r"^[A-Za-z0-9_-]{22}$"
_PATH = re.compile(r"/s/([A-Za-z0-9_-]{22})/?")
_UNNAMED = "A tree"
_UNLISTED = {"X-Robots-Tag": "noindex", "Cache-Control": "private, no-cache"}
_EVERYWHERE = {**_UNLISTED, "Cross-Origin-Resource-Policy": "cross-origin"}
_EMBEDDED_POLICY = PAGE_POLICY.replace("frame-ancestors 'none'", "frame-ancestors *")
_JPEG = {"image/jpeg": {"schema": {"type": "string", "format": "binary"}}}
_OVER = ("share_not_found", "share_revoked")
Token = Annotated[str, Path(json_schema_extra={"pattern": _TOKEN})]
Most = Annotated[int, Query(ge=1, le=10_000, description="px")]


def _shared(resources: AllResources, token: Token) -> Shared:
    return shares.open_share(resources, token)


SharedOf = Annotated[Shared, Depends(_shared)]


@router.get(
    "/s/{token}",
    response_class=HTMLResponse,
    responses={status: {"description": "The page says so"} for status in (HTTPStatus.NOT_FOUND, HTTPStatus.GONE)},
)
def get_shared_page(request: Request, resources: AllResources, token: Token, embed: str | None = None) -> Response:
    """Show a shared model; with ``?embed`` in the frame of any other page."""
    page = PAGE / "share.html"
    if not page.is_file():
        return PlainTextResponse(NOT_BUILT, HTTPStatus.NOT_FOUND)
    try:
        head, status = _head(request, shares.open_share(resources, token), token), HTTPStatus.OK
    except NotFound:
        head, status = "", HTTPStatus.NOT_FOUND
    except ShareOver:
        head, status = "", HTTPStatus.GONE
    embedded = {**_EVERYWHERE, "Content-Security-Policy": _EMBEDDED_POLICY}
    headers = {**_UNLISTED, "Content-Security-Policy": PAGE_POLICY} if embed is None else embedded
    return HTMLResponse(page.read_text().replace("</head>", f"{head}</head>"), status, headers)


@router.get("/s/{token}/model.json", responses=documented(*_OVER))
def get_shared_model(shared: SharedOf, response: Response) -> SharedModel:
    """Describe a shared model."""
    response.headers.update(_UNLISTED)
    return shared_view(shared)


@router.get(
    "/s/{token}/tree.glb",
    response_class=FileResponse,
    responses={**file_responses("model/gltf-binary"), **documented(*_OVER)},
)
def get_shared_tree(request: Request, shared: SharedOf) -> Response:
    """Send the tree of a shared model, which its page shows."""
    name = f"{shared.model.row.name or 'tree'}.glb" if shared.share.download else None
    return _file(request, shared, GLB, "model/gltf-binary", name)


@router.get(
    "/s/{token}/preview.png",
    response_class=FileResponse,
    responses={**file_responses("image/png"), **documented(*_OVER)},
)
def get_shared_preview(request: Request, shared: SharedOf) -> Response:
    """Send a picture of a shared model's tree, which pages elsewhere may show."""
    return _file(request, shared, PREVIEW, "image/png")


@router.get(
    "/s/{token}/photo.jpg",
    response_class=Response,
    responses={HTTPStatus.OK: {"content": _JPEG, "description": "The photo"}, **documented(*_OVER, "overloaded")},
)
def get_shared_photo(shared: SharedOf) -> Response:
    """Send the photo that the tree was made of, where the link shows it."""
    return Response(shares.photo_of(shared), headers=_UNLISTED, media_type="image/jpeg")


@router.get("/oembed", responses=documented("invalid", *_OVER))
def get_oembed(
    request: Request,
    resources: AllResources,
    url: Annotated[str, Query(max_length=2000, description="address of a shared model's page")],
    maxwidth: Most = WIDTH,
    maxheight: Most = HEIGHT,
) -> OEmbed:
    """Tell how to show a shared model in the frame of another page (oEmbed)."""
    place = urlsplit(url)
    found = _PATH.fullmatch(place.path)
    if found is None or place.netloc != request.url.netloc:
        raise NotFound("share")
    name = shares.open_share(resources, found[1]).model.row.name
    width, height = min(maxwidth, WIDTH), min(maxheight, HEIGHT)
    source = html.escape(f"{request.base_url}s/{found[1]}?embed")
    size = f'width="{width}" height="{height}"'
    frame = f'<iframe src="{source}" {size} title="{html.escape(name or _UNNAMED)}"></iframe>'
    origin = str(request.base_url).rstrip("/")
    return OEmbed(
        title=name or _UNNAMED, provider_name="treestroke", provider_url=origin, html=frame, width=width, height=height
    )


def _file(request: Request, shared: Shared, name: str, kind: str, download: str | None = None) -> Response:
    file = shared.model.files.get(name)
    if file is None:
        raise NotFound("file")
    response = send_blob(request, shared.resources, file.blob, kind, download)
    response.headers.update(_EVERYWHERE if name == PREVIEW else _UNLISTED)
    return response


def _head(request: Request, shared: Shared, token: str) -> str:
    """Return what other programs read of the page: its title, its picture, and where it tells how to embed it."""
    name, address = html.escape(shared.model.row.name or _UNNAMED), f"{request.base_url}s/{token}"
    about = f"{request.base_url}oembed?{urlencode({'url': address})}"
    return (
        f'<meta property="og:title" content="{name}"><meta property="og:image" content="{address}/preview.png">'
        f'<link rel="alternate" type="application/json+oembed" href="{html.escape(about)}" title="{name}">'
    )
