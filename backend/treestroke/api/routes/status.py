"""Health, limits and version of the service."""

from dataclasses import asdict, fields
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from treestroke import __version__
from treestroke.api.deps import AllResources, DispatcherOf, PrincipalOf, ResourcesOf, SettingsOf, WatcherOf
from treestroke.api.rates import ALL
from treestroke.api.request_counts import RequestCounts
from treestroke.api.routes.models import MAX_WAIT_SECONDS
from treestroke.codec.image import MAX_PIXELS, MAX_SIDE, MIN_SIDE
from treestroke.codec.photo_kinds import MEDIA_TYPES
from treestroke.codec.video_kinds import VIDEO_KINDS
from treestroke.core.pipeline.settings import Allowed, Choice, ModelSettings, Several, Span, Toggle
from treestroke.limits import (
    MAX_CLIP_BYTES,
    MAX_CLIP_SECONDS,
    MAX_EDIT_POINTS,
    MAX_EDITS,
    MAX_LEAF_BYTES,
    MAX_NAME,
    MAX_PHOTO_BYTES,
    MAX_PHOTOS,
    MAX_POINTS,
    MAX_SKETCH_BYTES,
    MAX_STROKES,
    MAX_TEXT_BYTES,
    MIN_CLIP_FRAMES,
    MIN_CLIP_SECONDS,
    MIN_PHOTOS,
)
from treestroke.schemas import Health, Limits, QuotaNow, RateNow, Version
from treestroke.service.engine_version import engine_version
from treestroke.service.files import files_on_offer
from treestroke.service.quotas import Used, used_by_team
from treestroke.service.readiness import readiness

router = APIRouter(tags=["service"])


@router.get("/livez")
async def live() -> Health:
    """Tell that this process responds."""
    return Health(status="ok")


@router.get("/readyz", responses={HTTPStatus.SERVICE_UNAVAILABLE: {"model": Health}})
def ready(resources: AllResources, dispatcher: DispatcherOf, response: Response) -> Health:
    """Tell whether requests can be taken, part by part; without workers or broker they are taken and wait."""
    health = readiness(resources, dispatcher)
    if health.status == "down":
        response.status_code = HTTPStatus.SERVICE_UNAVAILABLE
    return health


async def _rates(request: Request, principal: PrincipalOf) -> list[RateNow]:
    """Return the rates of who asks; a service without keys has none."""
    counts: RequestCounts = request.app.state.counts
    if not request.app.state.settings.hosted:
        return []
    standings = [await counts.standing(rate, principal.id) for rate in ALL]
    return [RateNow(**asdict(one.rate), remaining=one.remaining) for one in standings]


async def _streams(principal: PrincipalOf, watcher: WatcherOf) -> Used:
    return await watcher.streams_of(principal)


def _quotas(
    resources: ResourcesOf, settings: SettingsOf, streams: Annotated[Used, Depends(_streams)]
) -> list[QuotaNow]:
    """Return the quotas of the team of who asks; a service without keys has none."""
    if not settings.hosted:
        return []
    with resources.database.reading() as session:
        used = used_by_team(session, resources.quotas)
    return [QuotaNow(name=name, limit=limit or None, used=count) for name, limit, count in (*used, streams)]


@router.get("/v1/limits")
def limits(
    settings: SettingsOf,
    watcher: WatcherOf,
    rates: Annotated[list[RateNow], Depends(_rates)],
    quotas: Annotated[list[QuotaNow], Depends(_quotas)],
) -> Limits:
    """Return every limit of the service, and the settings of a model."""
    return Limits(
        photo_bytes=MAX_PHOTO_BYTES,
        photo_stored_bytes=settings.photo_mb * 10**6,
        photos_stored_bytes=settings.photos_mb * 10**6,
        photo_pixels=MAX_PIXELS,
        photo_side_min=MIN_SIDE,
        photo_side_max=MAX_SIDE,
        photo_formats=list(MEDIA_TYPES),
        strokes=MAX_STROKES,
        points=MAX_POINTS,
        json_bytes=MAX_TEXT_BYTES,
        name_length=MAX_NAME,
        leaf_bytes=MAX_LEAF_BYTES,
        sketch_bytes=MAX_SKETCH_BYTES,
        trace_seconds=settings.trace_seconds,
        capture_trace_seconds=settings.capture_trace_seconds,
        clip_bytes=MAX_CLIP_BYTES,
        clip_formats=[kind.media_type for kind in VIDEO_KINDS],
        clip_seconds=MAX_CLIP_SECONDS,
        clip_seconds_min=MIN_CLIP_SECONDS,
        clip_frames_min=MIN_CLIP_FRAMES,
        edits=MAX_EDITS,
        edit_points=MAX_EDIT_POINTS,
        model_seconds=settings.model_seconds,
        capture_photos_min=MIN_PHOTOS,
        capture_photos_max=MAX_PHOTOS,
        solve_seconds=settings.solve_seconds,
        wait_seconds=MAX_WAIT_SECONDS,
        settings={
            entry.name: {
                "default": entry.default,
                "meaning": entry.metadata["meaning"],
                "group": entry.metadata["group"],
                **_allowed(entry.metadata["allowed"]),
            }
            for entry in fields(ModelSettings)
        },
        keep_days=settings.keep_days,
        followers=watcher.places,
        rates=rates,
        quotas=quotas,
    )


@router.get("/v1/version")
def version() -> Version:
    """Return the version of treestroke."""
    return Version(version=__version__, engine=engine_version(), api="v1")


def _allowed(allowed: Allowed) -> dict[str, object]:
    match allowed:
        case Span():
            return {"min": allowed.low, "max": allowed.high, "whole": allowed.whole}
        case Toggle():
            return {"toggle": True}
        case Several():
            return {"names": [name for name in allowed.names if name in files_on_offer()], "several": True}
        case Choice():
            return {"names": list(allowed.names)}
