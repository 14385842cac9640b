"""Stored photos and models as the API shows them."""

from datetime import UTC, datetime
from typing import Any

from treestroke import schemas
from treestroke.service.jobs import GROWTH
from treestroke.service.stored_models import StoredModel
from treestroke.store.tables import PhotoRow


def photo_view(row: PhotoRow) -> schemas.PhotoInfo:
    """Return a photo as the API shows it."""
    return schemas.PhotoInfo(
        id=row.id,
        width=row.width,
        height=row.height,
        sha256=row.sha256,
        created=_time(row.created),
        image=f"/v1/photos/{row.id}/image",
        warnings=[schemas.StrokeWarning(**warning) for warning in row.warnings],
    )


def model_view(model: StoredModel) -> schemas.ModelInfo:
    """Return a model as the API shows it."""
    row, path = model.row, f"/v1/models/{model.row.id}"
    names = [*model.drawings, "project", *(model.files if row.status == "succeeded" else ())]
    return schemas.ModelInfo(
        id=row.id,
        name=row.name,
        photo=row.photo,
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
        created=_time(row.created),
        started=None if row.started is None else _time(row.started),
        finished=None if row.finished is None else _time(row.finished),
    )


def _score(report: dict[str, Any] | None) -> dict[str, float] | None:
    return None if report is None else report["score"]


def _taken(report: dict[str, Any] | None) -> schemas.Taken | None:
    taken = (report or {}).get("taken")  # older reports have none
    return None if taken is None else schemas.Taken(**taken)


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
