"""A data folder of the program before parts had a table of their own: see tests/data/SOURCES.md."""

import json
import tarfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.conftest import DATA
from tests.rows import Messages, claim

from treestroke.service import stored_models
from treestroke.service.dispatch import Dispatcher
from treestroke.service.doctor import examine_deployment
from treestroke.service.engine_version import engine_version
from treestroke.service.jobs import grow_model
from treestroke.service.projects import Projects
from treestroke.service.retention import Sweeper
from treestroke.service.tracing_pool import TracingPool
from treestroke.settings import read_settings
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.queries import referenced
from treestroke.store.scope import LOCAL, SERVICE

PARTS = {
    "photo": ["photo", "strokes", "side", "leaf", "fruit"],
    "sketches": ["front", "side"],
    "over a photo": ["photo", "front"],
    "deleted": ["photo", "strokes"],
    "queued": ["photo", "strokes", "side"],
}


@dataclass
class Upgraded:
    """The folder after the upgrade, and what the program before told of its models, by their names."""

    database: Database
    blobs: Blobs
    told: dict[str, dict[str, Any]]

    def model(self, name: str) -> stored_models.StoredModel:
        return stored_models.find_model(self.database, self.told[name]["id"], deleted=True)


@pytest.fixture
def old_folder(tmp_path: Path) -> Path:
    with tarfile.open(DATA / "data_folder_0005.tar.xz") as archive:
        archive.extractall(tmp_path, filter="data")
    return tmp_path


@pytest.fixture
def upgraded(old_folder: Path) -> Iterator[Upgraded]:
    database = Database(old_folder).of(LOCAL)
    database.migrate()
    assert database.current()
    yield Upgraded(
        database, open_blobs(database, old_folder).of(LOCAL), json.loads((old_folder / "told.json").read_text())
    )
    database.close()


def test_all_models_are_listed_and_found_with_their_parts_and_files(upgraded: Upgraded) -> None:
    listed, _ = stored_models.list_models(upgraded.database, None, 10)
    assert [model.row.name for model in listed] == [name for name in reversed(PARTS) if name != "deleted"]
    for name, parts in PARTS.items():
        model, told = upgraded.model(name), upgraded.told[name]
        assert list(model.inputs.parts) == parts
        assert {file: part.blob for file, part in model.drawings.items()} == told["drawings"]
        assert {file.name: file.blob for file in model.files.values()} == told["files"]


def test_project_files_have_the_same_bytes(upgraded: Upgraded, tracers: TracingPool) -> None:
    projects = Projects(upgraded.blobs, tracers)
    for name, told in upgraded.told.items():
        assert projects.pack(upgraded.model(name)).result(30).sha256 == told["project"]
    projects.close()


def test_a_queued_model_grows(upgraded: Upgraded, monkeypatch: pytest.MonkeyPatch) -> None:
    """The engine that it was accepted for has no workers any more."""
    dispatcher = Dispatcher(upgraded.database.of(SERVICE), upgraded.blobs, Messages(), 0)
    monkeypatch.setattr("treestroke.service.dispatch.LEASE_SECONDS", 0.0)
    dispatcher.take_over()
    job = claim(upgraded.database, upgraded.model("queued").row)
    grow_model(upgraded.database, upgraded.blobs, job, 60)
    model = upgraded.model("queued")
    assert (model.row.status, model.row.error, model.row.engine) == ("succeeded", None, engine_version())
    assert upgraded.blobs.get(model.files["tree.glb"].blob).startswith(b"glTF")


def test_a_deleted_model_is_restored_and_nothing_that_is_referred_to_is_swept(upgraded: Upgraded) -> None:
    stored_models.restore(upgraded.database, upgraded.told["deleted"]["id"])
    clock = [0.0]
    sweeper = Sweeper(upgraded.database, upgraded.blobs, 0, threading.Event(), lambda: clock[0])
    for _ in range(3):
        sweeper.sweep()
        clock[0] += 13 * 3600.0
    with upgraded.database.reading() as session:
        kept = referenced(session)
    assert {name for _, names in upgraded.blobs.objects.pages() for name in names} == kept
    assert all(part.blob in kept for name in PARTS for part in upgraded.model(name).parts.values())


def test_the_doctor_finds_an_old_version_before_the_upgrade_and_all_files_whole_after(old_folder: Path) -> None:
    old_folder.chmod(0o700)
    settings = read_settings(data=str(old_folder), port=0)
    before = {finding.part: finding.found for finding in examine_deployment(settings)}
    assert before["database"] == "of an older version"
    database = Database(old_folder).of(LOCAL)
    database.migrate()
    database.close()
    after = {finding.part: finding.found for finding in examine_deployment(settings)}
    assert (after["database"], after["files"]) == ("sound", "all 10 intact")
