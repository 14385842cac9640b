import base64
import hashlib
import json
import os
import time
import tracemalloc
from collections.abc import Iterator
from concurrent.futures import wait

import pytest
from tests.api import drawn, sketched
from tests.rows import add_model

from treestroke.codec.project import Project, read_project
from treestroke.service import model_request, photos, stored_models
from treestroke.service.photos import Resources
from treestroke.service.projects import AT_ONCE, WAITING, Packed, Projects
from treestroke.service.stored_models import StoredModel
from treestroke.service.tracing_pool import Overloaded
from treestroke.store.blobs import Damaged

SECONDS = 300
"""Emergency exit of what is waited for."""


@pytest.fixture
def projects(resources: Resources) -> Iterator[Projects]:
    made = Projects(resources.blobs, resources.tracers)
    yield made
    made.close()


def packed(projects: Projects, model: StoredModel) -> Packed:
    return projects.pack(model).result(SECONDS)


def project_of(projects: Projects, model: StoredModel) -> Project:
    with packed(projects, model).path.open("rb") as file:
        return read_project(file, "x")


def model_of(resources: Resources, content: bytes, seed: int = 0) -> StoredModel:
    """Write the rows of a model whose photo has this content, whatever it is."""
    blobs = {"photo": resources.blobs.put(content), "strokes": resources.blobs.put(b"{}")}
    return stored_models.find_model(resources.database, add_model(resources.database, blobs, seed=seed).id)


def test_a_project_is_photo_strokes_and_settings_whole(resources: Resources, projects: Projects) -> None:
    photo = photos.add_photo(resources, drawn.encoded())
    asked = model_request.read_order(json.dumps(drawn.request(photo.id, seed=7)).encode())
    model = stored_models.accept_model(resources, asked, None)
    project = project_of(projects, model)
    assert list(project.inputs.parts) == ["photo", "strokes"]
    assert project.inputs.parts["photo"] == resources.blobs.get(photo.blob)
    assert json.loads(project.inputs.parts["strokes"]) == {**drawn.STROKES, "erase": []}
    assert project.settings == {**model.row.settings, "seed": 7}


def test_a_project_of_sketches_holds_them_as_they_were_sent(resources: Resources, projects: Projects) -> None:
    sketches = {"front": sketched.FRONT, "side": sketched.pictured(sketched.SIDE)}
    fruit = base64.b64encode(sketched.berry()).decode()
    asked = model_request.read_order(json.dumps(sketched.request(sketches=sketches, fruit=fruit)).encode())
    model = stored_models.accept_model(resources, asked, None)
    assert list(model.drawings) == ["front.json", "side.png"]
    parts = project_of(projects, model).inputs.parts
    assert list(parts) == ["front", "side", "fruit"]
    assert json.loads(parts["front"]) == sketched.FRONT
    assert parts["side"].startswith(b"\x89PNG")
    assert parts["fruit"] == sketched.berry()


def test_models_of_the_same_parts_settings_and_seed_share_a_project_that_is_packed_once(
    resources: Resources, projects: Projects
) -> None:
    first, same, other = (model_of(resources, b"photo", seed=seed) for seed in (0, 0, 1))
    made = packed(projects, first)
    before = made.path.stat()
    assert made.sha256 == hashlib.sha256(made.path.read_bytes()).hexdigest()
    assert packed(projects, same) == made
    assert (made.path.stat().st_mtime_ns, made.path.stat().st_ino) == (before.st_mtime_ns, before.st_ino)
    assert packed(projects, other).sha256 != made.sha256


def test_a_large_project_is_never_in_memory(resources: Resources, projects: Projects) -> None:
    model = model_of(resources, bytes(60_000_000))
    tracemalloc.start()
    made = packed(projects, model)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert made.size > 60_000_000
    assert peak < 5_000_000


def test_what_was_asked_for_longest_ago_goes_first(
    resources: Resources, projects: Projects, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("treestroke.service.projects.MAX_CACHE_BYTES", 250_000)
    models = [model_of(resources, bytes([at]) * 100_000) for at in range(3)]
    first, second = (packed(projects, model) for model in models[:2])
    packed(projects, models[0])
    third = packed(projects, models[2])
    assert [one.path.exists() for one in (first, second, third)] == [True, False, True]
    assert packed(projects, models[1]).sha256 == second.sha256


def test_what_is_gone_changed_or_failed_is_packed_anew(resources: Resources, projects: Projects) -> None:
    model = model_of(resources, b"photo")
    blob = resources.blobs.path(model.parts["photo"].blob)
    blob.rename(blob.with_suffix(".away"))
    with pytest.raises(Damaged):
        packed(projects, model)
    assert list((resources.blobs.data / "projects").iterdir()) == []
    blob.with_suffix(".away").rename(blob)
    made = packed(projects, model)
    for harm in (made.path.unlink, lambda: made.path.write_bytes(b"")):
        harm()
        again = packed(projects, model)
        assert (again.sha256, again.size) == (made.sha256, made.size)
        assert hashlib.sha256(made.path.read_bytes()).hexdigest() == made.sha256


def test_what_is_kept_goes_at_the_next_start(resources: Resources, projects: Projects) -> None:
    made = packed(projects, model_of(resources, b"photo"))
    Projects(resources.blobs, resources.tracers).close()
    assert not made.path.exists()


def test_few_are_packed_at_once_more_wait_and_still_more_are_refused(resources: Resources, projects: Projects) -> None:
    model = model_of(resources, b"photo")
    blob = resources.blobs.path(model.parts["photo"].blob)
    blob.unlink()
    os.mkfifo(blob)  # whoever opens it to read waits for somebody who writes
    rows = [
        add_model(resources.database, {"photo": blob.name, "strokes": "b" * 64}, seed=seed)
        for seed in range(WAITING + 1)
    ]
    models = [stored_models.find_model(resources.database, row.id) for row in rows]
    promised = [projects.pack(model) for model in models[:WAITING]]
    try:
        deadline = time.monotonic() + SECONDS
        while sum(one.running() for one in promised) < AT_ONCE and time.monotonic() < deadline:
            time.sleep(0.01)
        assert [one.running() for one in promised] == [True] * AT_ONCE + [False] * (WAITING - AT_ONCE)
        assert projects.pack(models[0]) is promised[0]
        with pytest.raises(Overloaded, match="too many projects"):
            projects.pack(models[WAITING])
    finally:
        while wait(promised, 0.01).not_done:
            os.close(os.open(blob, os.O_RDWR | os.O_NONBLOCK))
    assert all(isinstance(one.exception(), Damaged) for one in promised)
