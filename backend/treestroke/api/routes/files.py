"""A model's files."""

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse

from treestroke.api.deps import ModelId, ShelfOf
from treestroke.api.errors import documented
from treestroke.api.sending import file_answers, send_blob
from treestroke.service import models
from treestroke.service.jobs import GLB, PREVIEW
from treestroke.service.photos import NotFound, Shelf

router = APIRouter(prefix="/v1/models/{id}", tags=["files"])
_GLB, _PNG, _ZIP, _JSON = "model/gltf-binary", "image/png", "application/zip", "application/json"


@router.get("/tree.glb", response_class=FileResponse, responses=file_answers(_GLB))
def get_tree(request: Request, shelf: ShelfOf, id: ModelId) -> Response:
    """Download the tree."""
    return _file(request, shelf, id, GLB, _GLB)


@router.get("/preview.png", response_class=FileResponse, responses=file_answers(_PNG))
def get_preview(request: Request, shelf: ShelfOf, id: ModelId) -> Response:
    """Look at the tree: the front view at the photo's framing beside a 3/4 view."""
    return _file(request, shelf, id, PREVIEW, _PNG)


@router.get("/strokes.json", response_class=FileResponse, responses=file_answers(_JSON, "Strokes"))
def get_strokes(request: Request, shelf: ShelfOf, id: ModelId) -> Response:
    """Give the strokes that the tree was made of."""
    return send_blob(request, shelf, models.see(shelf.database, id).row.strokes_blob, _JSON)


@router.get("/project", response_class=FileResponse, responses={**file_answers(_ZIP), **documented(507)})
def get_project(request: Request, shelf: ShelfOf, id: ModelId) -> Response:
    """Download NAME.treestroke: photo, strokes and settings, for the command line and the page."""
    row, blob = models.project_of(shelf, id)
    return send_blob(request, shelf, blob, _ZIP, f"{row.name or row.id}.treestroke")


def _file(request: Request, shelf: Shelf, id: str, name: str, kind: str) -> Response:
    seen = models.see(shelf.database, id)
    if seen.row.status != "succeeded":
        raise NotFound("file")
    download = f"{seen.row.name or seen.row.id}.glb" if name == GLB else None
    return send_blob(request, shelf, seen.files[name].blob, kind, download)
