"""Stored photos, models and captures as the API shows them."""

from collections.abc import Sequence
from typing import Any

from treestroke import capture_schemas, clip_schemas, schemas
from treestroke.codec.cameras import plain_photo_camera
from treestroke.codec.structure import plain_cloud
from treestroke.core.capture import Structure
from treestroke.limits import MAX_CLOUD_POINTS
from treestroke.service.captures import StoredCapture
from treestroke.service.jobs import GLB, GROWTH
from treestroke.service.makers import Maker, Makers
from treestroke.service.shares import Shared
from treestroke.service.stored_models import StoredModel
from treestroke.share_schemas import SharedModel, ShareInfo
from treestroke.store.tables import CapturePhoto, ClipRow, PhotoRow, Share
from treestroke.store.times import iso_time


def photo_view(row: PhotoRow) -> schemas.PhotoInfo:
    """Return a photo as the API shows it."""
    return schemas.PhotoInfo(
        id=row.id,
        width=row.width,
        height=row.height,
        sha256=row.sha256,
        created=iso_time(row.created),
        image=f"/v1/photos/{row.id}/image",
        warnings=[schemas.StrokeWarning(**warning) for warning in row.warnings],
    )


def clip_view(row: ClipRow, makers: Makers) -> clip_schemas.ClipInfo:
    """Return a clip as the API shows it; ``makers`` has who made it."""
    return clip_schemas.ClipInfo(
        id=row.id,
        name=row.name,
        width=row.width,
        maker=_maker(makers.get(row.maker)),
        height=row.height,
        frames=row.frames,
        frames_per_second=row.frames_per_second,
        seconds=round(row.frames / row.frames_per_second, 3),
        bytes=row.bytes,
        sha256=row.sha256,
        media_type=row.media_type,
        created=iso_time(row.created),
        video=f"/v1/clips/{row.id}/video",
        notes=[schemas.StrokeWarning(**note) for note in row.warnings],
    )


def model_view(model: StoredModel) -> schemas.ModelInfo:
    """Return a model as the API shows it."""
    row, path = model.row, f"/v1/models/{model.row.id}"
    names = [*model.drawings, "project", *(model.files if row.status == "succeeded" else ())]
    return schemas.ModelInfo(
        id=row.id,
        name=row.name,
        tags=row.tags,
        maker=_maker(model.maker),
        photo=row.photo,
        capture=row.capture,
        clip=row.clip,
        status=row.status,  # type: ignore[arg-type]
        phase=row.phase,
        phase_fraction=row.phase_fraction,
        progress=round(row.progress, 4),
        queue_position=model.queue_position,
        eta_s=None if model.eta_s is None else round(model.eta_s, 1),
        attempt=row.attempt,
        error=schemas.Failure(**row.error) if row.error else None,
        score=_score(row.report),
        taken=_taken(row.report),
        report=row.report,
        files={name: f"{path}/{name}" for name in names if name != GROWTH},
        settings=row.settings,
        seed=row.seed,
        engine=row.engine,
        created=iso_time(row.created),
        started=None if row.started is None else iso_time(row.started),
        finished=None if row.finished is None else iso_time(row.finished),
    )


def capture_state(capture: StoredCapture) -> capture_schemas.CaptureState:
    """Return how far a capture is, as the API shows it."""
    return capture_schemas.CaptureState(**_state(capture))


def capture_view(capture: StoredCapture, structure: Structure | None) -> capture_schemas.CaptureInfo:
    """Return a capture as the API shows it, with what was found of its photos."""
    shown = _state(capture)
    shown["photos"] = [capture_photo_view(photo, structure) for photo in capture.photos]
    if structure is None:
        return capture_schemas.CaptureInfo(**shown, cameras=[], cloud=None)
    return capture_schemas.CaptureInfo(
        **shown,
        cameras=_cameras(capture.photos, structure),
        cloud=capture_schemas.CloudInfo(**plain_cloud(structure.cloud, MAX_CLOUD_POINTS)),
    )


def _cameras(photos: Sequence[CapturePhoto], structure: Structure) -> list[capture_schemas.CameraInfo]:
    """Return the cameras that were found, in pixels of the upright photos: large ones are solved smaller."""
    sizes = {photo.name: (photo.width, photo.height) for photo in photos}
    cameras = {one.name: one.camera.resized(*sizes[one.name]) for one in structure.photos}
    return [capture_schemas.CameraInfo(**plain_photo_camera(name, camera)) for name, camera in cameras.items()]


def capture_photo_view(row: CapturePhoto, structure: Structure | None = None) -> capture_schemas.CapturePhotoInfo:
    """Return a photo of a capture as the API shows it, with what was found of it."""
    unused = {} if structure is None else {one.name: one for one in structure.unused}
    why = unused.get(row.name)
    return capture_schemas.CapturePhotoInfo(
        id=row.id,
        name=row.name,
        width=row.width,
        height=row.height,
        sha256=row.sha256,
        focal_px=row.focal_length_px,
        created=iso_time(row.created),
        image=f"/v1/captures/{row.capture}/photos/{row.id}/image",
        warnings=[schemas.StrokeWarning(**warning) for warning in row.warnings],
        used=None if structure is None else any(one.name == row.name for one in structure.photos),
        reason=None if why is None else schemas.Reason(code=why.code, detail=why.detail),
    )


def _state(capture: StoredCapture) -> dict[str, Any]:
    row, solve = capture.row, capture.solve
    known: dict[str, Any] = {"engine": None, "started": None, "finished": None, "error": None, "phase": None}
    if solve is not None:
        known = {
            "engine": solve.engine,
            "started": None if solve.started is None else iso_time(solve.started),
            "finished": None if solve.finished is None else iso_time(solve.finished),
            "error": schemas.Failure(**solve.error) if solve.error else None,
            "phase": solve.phase,
        }
    return {
        **known,
        "id": row.id,
        "name": row.name,
        "maker": _maker(capture.maker),
        "status": capture.status,
        "phase_fraction": 0.0 if solve is None else solve.phase_fraction,
        "progress": 0.0 if solve is None else round(solve.progress, 4),
        "queue_position": capture.queue_position,
        "eta_s": None if capture.eta_s is None else round(capture.eta_s, 1),
        "attempt": 0 if solve is None else solve.attempt,
        "photo_count": len(capture.photos),
        "created": iso_time(row.created),
    }


def share_view(share: Share, url: str | None = None) -> ShareInfo:
    """Return a link to a model as the API shows it; its address where it was just made."""
    return ShareInfo(
        id=share.id,
        url=url,
        created=iso_time(share.created),
        expires=iso_time(share.expires),
        revoked=None if share.revoked is None else iso_time(share.revoked),
        photo=share.photo,
        download=share.download,
    )


def shared_view(shared: Shared) -> SharedModel:
    """Return what a link tells of a model: nothing of who made it."""
    row, share, report = shared.model.row, shared.share, shared.model.row.report or {}
    taken = _taken(report)
    return SharedModel(
        name=row.name,
        bytes=shared.model.files[GLB].bytes,
        foliage=None if taken is None else taken.foliage,
        form=None if taken is None else taken.form,
        height=report.get("measures", {}).get("height", {}).get("value"),
        photo=share.photo,
        download=share.download,
        expires=iso_time(share.expires),
    )


def _maker(maker: Maker | None) -> schemas.MakerInfo | None:
    return None if maker is None else schemas.MakerInfo(id=maker.id, name=maker.name)


def _score(report: dict[str, Any] | None) -> dict[str, float] | None:
    return None if report is None else report["score"]


def _taken(report: dict[str, Any] | None) -> schemas.Taken | None:
    taken = (report or {}).get("taken")  # older reports have none
    return None if taken is None else schemas.Taken(**taken)
