"""Grow one queued model in an attempt: make the tree from its stored parts, and publish its files."""

import json
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from treestroke.codec.archive import zipped
from treestroke.codec.image import encode_png
from treestroke.codec.inputs import Inputs, part_of
from treestroke.codec.project import stored_part
from treestroke.codec.skeleton import plain_grown
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.progress import Report
from treestroke.service.attempts import Heartbeat, carry_out, persist, publish
from treestroke.service.capture_photos import warnings_of
from treestroke.service.clip_loading import StoredClip
from treestroke.service.files import Bundle
from treestroke.service.loading import PartLike, load_settings, load_stored_capture
from treestroke.service.model import Options, make_tree
from treestroke.service.progress_estimate import ProgressEstimate, model_phases
from treestroke.store import queries
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import add_file, succeed
from treestroke.store.objects import StorageAway
from treestroke.store.scope import Scope
from treestroke.store.tables import ModelPart, ModelRow

GLB, PREVIEW, GROWTH = "tree.glb", "preview.png", "growth.json"


def grow_model(database: Database, blobs: Blobs, job: ModelRow, seconds: float) -> None:
    """Grow a model that was claimed, within some seconds, and publish it whole or not at all."""

    def grow(job: ModelRow) -> None:
        with database.reading() as session:
            inputs = Inputs.of(queries.parts(session, [job.id])[job.id])
        estimate = ProgressEstimate(model_phases(load_settings(job.settings), inputs.source))
        with Heartbeat(database, job, estimate, seconds) as heartbeat:
            report, files = _make(database, blobs.of(Scope(job.team, job.maker)), job, inputs, heartbeat)
        _publish(database, job, report, files)

    carry_out(database, job, grow)


def _make(
    database: Database, blobs: Blobs, job: ModelRow, inputs: Inputs[ModelPart], heartbeat: Heartbeat[ModelRow]
) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    """Make the tree and store its files, which are seen only once they are published; return report and files."""
    contents = _contents(blobs, inputs, heartbeat.report)

    def show(grown: LiveTree) -> None:
        content = json.dumps(plain_grown(grown), separators=(",", ":")).encode()
        first = {} if job.preview_seq else {"preview_seq": ModelRow.seq + 1}
        # A view of the growing tree is not worth failing for where storage is away; the finished tree is waited for.
        with suppress(SQLAlchemyError, StorageAway):
            blob = blobs.put(content)
            with database.writing() as session:
                add_file(session, job, GROWTH, blob, len(content), **first)

    made = make_tree(contents, Options.of(job.settings, job.seed), heartbeat.report, show)
    made = made.with_warnings(persist(lambda: _mended_in_photos(database, job)))
    heartbeat.report("preview", 0.0)
    trees = _packed(made.bundles)
    outputs = {**trees, PREVIEW: encode_png(made.preview())}
    heartbeat.report("preview", 1.0)
    files = {name: (persist(partial(blobs.put, content)), len(content)) for name, content in outputs.items()}
    heartbeat.report("preview", 1.0)
    return {**made.report, "files": {name: len(content) for name, content in trees.items()}}, files


def _contents(blobs: Blobs, inputs: Inputs[ModelPart], report: Report) -> Inputs[PartLike]:
    """Return the parts as `make_tree` takes them."""
    contents: dict[str, PartLike] = {}
    for done, (name, part) in enumerate(inputs.parts.items()):
        report("decode", done / len(inputs.parts))
        contents[name] = _content(blobs, name, part.blob)
    return Inputs.of(contents)


def _content(blobs: Blobs, name: str, blob: str) -> PartLike:
    """Return a part's bytes; a clip's file by its path, and a capture's photo decoded, so that none is kept whole."""
    part = part_of(name)
    if part.kind == "clip":
        return StoredClip(blobs.check(blob))
    content = blobs.get(blob)
    return load_stored_capture(name.partition("/")[2], content) if part.many else stored_part(name, content)


def _mended_in_photos(database: Database, job: ModelRow) -> list[dict[str, Any]]:
    """Return what was mended when the photos were read: their blobs hold only the pixels."""
    with database.reading() as session:
        if job.capture is not None:
            return warnings_of(queries.capture_photos(session, [job.capture])[job.capture])
        row = None if job.photo is None else queries.photo(session, job.photo, deleted=True)
        return [] if row is None else row.warnings


def _packed(bundles: Mapping[str, Bundle]) -> dict[str, bytes]:
    """Return each bundle as one file: the file itself where there is only one, else a ZIP of all."""
    return {
        name if len(bundle) == 1 else f"{name}.zip": next(iter(bundle.values())) if len(bundle) == 1 else zipped(bundle)
        for name, bundle in bundles.items()
    }


def _publish(database: Database, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> None:
    publish(database, job, lambda session: succeed(session, job, report, files))
