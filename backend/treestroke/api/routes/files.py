"""A model's files."""

import asyncio
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Path, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse

from treestroke.api.deps import ModelId, ProjectsOf, ResourcesOf
from treestroke.api.errors import documented
from treestroke.api.sending import file_responses, send_blob, send_file
from treestroke.codec.inputs import SIDES
from treestroke.service import stored_models
from treestroke.service.jobs import GLB, PREVIEW
from treestroke.service.photos import NotFound, Resources
from treestroke.service.tracing_pool import Overloaded

router = APIRouter(prefix="/v1/models/{id}", tags=["files"])
_GLB, _PNG, _ZIP, _JSON = "model/gltf-binary", "image/png", "application/zip", "application/json"
_OTHER = "application/octet-stream"
_PACKING_SECONDS = 20.0
"""A request waits no longer for its project, which is packed all the same; it is sent again later."""
_MEDIA_TYPES = {
    ".glb": _GLB,
    ".zip": _ZIP,
    ".json": _JSON,
    ".usdz": "model/vnd.usdz+zip",
    ".ply": _OTHER,
    ".swc": "text/plain; charset=utf-8",
    ".csv": "text/csv; charset=utf-8",
}
"""Media types by ending."""
_ENDING = r"^[a-z0-9]{2,10}(\.[a-z0-9]{2,10}){0,2}$"
_MANY: dict[int | str, dict[str, Any]] = {
    status: {
        **answer,
        "content": {kind: {"schema": {"type": "string", "format": "binary"}} for kind in _MEDIA_TYPES.values()},
    }
    if status in (HTTPStatus.OK, HTTPStatus.PARTIAL_CONTENT)
    else answer
    for status, answer in file_responses(_GLB).items()
}
_SKETCH: dict[int | str, dict[str, Any]] = {
    status: {**answer, "content": {**answer["content"], **file_responses(_PNG)[status]["content"]}}
    if status in (HTTPStatus.OK, HTTPStatus.PARTIAL_CONTENT)
    else answer
    for status, answer in file_responses(_JSON, "StrokeSketch").items()
}
View = Annotated[str, Path(json_schema_extra={"pattern": f"^({'|'.join(SIDES)})$"})]
SketchEnding = Annotated[str, Path(json_schema_extra={"pattern": "^(json|png)$"})]
Ending = Annotated[str, Path(json_schema_extra={"pattern": _ENDING, "example": "glb"})]


@router.get("/tree.glb", response_class=FileResponse, responses=file_responses(_GLB))
def get_tree(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download the tree."""
    return _file(request, resources, id, GLB)


@router.get("/preview.png", response_class=FileResponse, responses=file_responses(_PNG))
def get_preview(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download a picture of the tree: the front view at the photo's framing beside a 3/4 view."""
    return _file(request, resources, id, PREVIEW)


@router.get("/strokes.json", response_class=FileResponse, responses=file_responses(_JSON, "Strokes"))
def get_strokes(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download the strokes that the tree was made of."""
    return _drawing(request, resources, id, "strokes.json")


@router.get("/views.json", response_class=FileResponse, responses=file_responses(_JSON, "CaptureStrokes"))
def get_views(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download the strokes over the photos of a capture that the tree was made of."""
    return _drawing(request, resources, id, "views.json")


@router.get("/frame_strokes.json", response_class=FileResponse, responses=file_responses(_JSON, "FrameStrokes"))
def get_frame_strokes(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download the strokes over a frame of a clip that the tree was made of."""
    return _drawing(request, resources, id, "frame_strokes.json")


@router.get("/edits.json", response_class=FileResponse, responses=file_responses(_JSON, "Edits"))
def get_edits(request: Request, resources: ResourcesOf, id: ModelId) -> Response:
    """Download the edits of the visible branches of a capture that the tree was made of."""
    return _drawing(request, resources, id, "edits.json")


@router.get(
    "/project",
    response_class=FileResponse,
    responses={**file_responses(_ZIP), **documented("overloaded", "storage_full")},
)
async def get_project(request: Request, resources: ResourcesOf, projects: ProjectsOf, id: ModelId) -> Response:
    """Download NAME.treestroke: all that the tree is made of, for the command line and the page."""
    model = await run_in_threadpool(stored_models.find_model, resources.database, id)
    packing = asyncio.shield(asyncio.wrap_future(projects.pack(model)))
    try:
        packed = await asyncio.wait_for(packing, _PACKING_SECONDS)
    except TimeoutError:
        raise Overloaded("the project is still being packed") from None
    return send_file(request, packed.path, packed.sha256, _ZIP, f"{model.row.name or id}.treestroke")


@router.get("/tree.{ending}", response_class=FileResponse, responses=_MANY)
def get_tree_file(request: Request, resources: ResourcesOf, id: ModelId, ending: Ending) -> Response:
    """Download one of the further files that the settings asked for; ``files`` of the model names them."""
    return _file(request, resources, id, f"tree.{ending}")


@router.get("/{view}.{ending}", response_class=FileResponse, responses=_SKETCH)
def get_sketch(request: Request, resources: ResourcesOf, id: ModelId, view: View, ending: SketchEnding) -> Response:
    """Download a sketch that the tree was made of: front.json or front.png, side.json or side.png."""
    if view not in SIDES:
        raise NotFound("file")
    return _drawing(request, resources, id, f"{view}.{ending}")


def _drawing(request: Request, resources: Resources, id: str, name: str) -> Response:
    part = stored_models.find_model(resources.database, id).drawings.get(name)
    if part is None:
        raise NotFound("file")
    return send_blob(request, resources, part.blob, part.media_type)


def _file(request: Request, resources: Resources, id: str, name: str) -> Response:
    model = stored_models.find_model(resources.database, id)
    file = model.files.get(name)
    if model.row.status != "succeeded" or file is None:
        raise NotFound("file")
    if name == PREVIEW:
        return send_blob(request, resources, file.blob, _PNG)
    media_type = _MEDIA_TYPES.get(name[name.rindex(".") :], _OTHER)
    return send_blob(request, resources, file.blob, media_type, f"{model.row.name or id}{name.removeprefix('tree')}")
