"""Rows as their readers see them."""

from datetime import UTC, datetime
from typing import Any

from treestroke import schemas
from treestroke.service.jobs import GROWTH
from treestroke.service.models import Seen
from treestroke.store.tables import PhotoRow


def photo_view(row: PhotoRow) -> schemas.PhotoInfo:
    """Show a photo."""
    return schemas.PhotoInfo(
        id=row.id,
        width=row.width,
        height=row.height,
        sha256=row.sha256,
        created=_time(row.created),
        image=f"/v1/photos/{row.id}/image",
        warnings=[schemas.StrokeWarning(**warning) for warning in row.warnings],
    )


def model_view(seen: Seen) -> schemas.ModelInfo:
    """Show a model."""
    row, place = seen.row, f"/v1/models/{seen.row.id}"
    names = [*row.drawings, "project", *(seen.files if row.status == "succeeded" else ())]
    return schemas.ModelInfo(
        id=row.id,
        name=row.name,
        photo=row.photo,
        status=row.status,  # type: ignore[arg-type]
        phase=row.phase,
        phase_fraction=row.phase_fraction,
        progress=round(row.progress, 4),
        queue_position=seen.queue_position,
        eta_s=None if seen.eta_s is None else round(seen.eta_s, 1),
        attempt=row.attempt,
        error=schemas.Failure(**row.error) if row.error else None,
        score=_score(row.report),
        report=row.report,
        files={name: f"{place}/{name}" for name in names if name != GROWTH},
        settings=row.settings,
        seed=row.seed,
        engine=row.engine,
        created=_time(row.created),
        started=None if row.started is None else _time(row.started),
        finished=None if row.finished is None else _time(row.finished),
    )


def _score(report: dict[str, Any] | None) -> dict[str, float] | None:
    return None if report is None else report["score"]


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
