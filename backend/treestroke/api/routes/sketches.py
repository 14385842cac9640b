"""Sketches traced as they are drawn."""

from typing import Any

from fastapi import APIRouter, Response

from treestroke.api.deps import JsonBody, ResourcesOf
from treestroke.api.errors import BODY, documented
from treestroke.schemas import SketchTraceAnswer
from treestroke.service.tracer import sketch_answer
from treestroke.wire_requests import SKETCHES_EXAMPLE

router = APIRouter(prefix="/v1/sketches", tags=["sketches"])
_TRACE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/SketchTraceRequest"},
                "example": {**SKETCHES_EXAMPLE, "rev": 7, "grow": False},
            }
        },
    }
}


@router.post(
    "/trace",
    response_model=SketchTraceAnswer,
    responses=documented(*BODY),
    openapi_extra=_TRACE,
)
def trace_sketches(resources: ResourcesOf, body: JsonBody) -> Response:
    """Find the branches that sketches show; with ``grow`` the whole tree's skeleton too. Nothing is kept."""
    return Response(resources.tracers("", sketch_answer, body), media_type="application/json")
