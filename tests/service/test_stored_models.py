import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from sqlalchemy import Engine, event
from tests.api import drawn, sketched
from tests.postgres import KINDS
from tests.rows import add_model, claim, find

from treestroke.core.errors import StrokesError
from treestroke.service import model_request, photos, stored_models
from treestroke.service.engine_version import engine_version
from treestroke.service.model_request import ModelOrder
from treestroke.service.photos import NotFound, Resources
from treestroke.service.stored_models import KeyReused
from treestroke.store.blobs import Damaged
from treestroke.store.database import Database
from treestroke.store.leases import change_engine, succeed
from treestroke.store.tables import ModelRow, PhotoRow


@pytest.fixture(params=KINDS)
def database_kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def order(resources: Resources, photo: str, **others: Any) -> ModelOrder:
    return model_request.read_order(json.dumps(drawn.request(photo, **others)).encode())


def finished(resources: Resources, id: str, glb: bytes, by: str = "") -> None:
    """Publish a model as its worker does."""
    row = find(resources.database, id)
    if by:
        with resources.database.writing() as session:
            change_engine(session, row.engine, by)
            row.engine = by
    job, blob = claim(resources.database, row), resources.blobs.put(glb)
    with resources.database.writing() as session:
        assert succeed(session, job, {"score": {}}, {"tree.glb": (blob, len(glb))})


def count(resources: Resources, table: type[ModelRow] | type[PhotoRow]) -> int:
    with resources.database.reading() as session:
        return session.query(table).count()


def test_a_model_is_answered_from_one_of_the_same_input_alone(resources: Resources) -> None:
    first_photo, same_photo, other_photo = (
        photos.add_photo(resources, drawn.encoded(seed=seed)).id for seed in (0, 0, 1)
    )
    first = stored_models.accept_model(resources, order(resources, first_photo), None).row
    assert (
        stored_models.accept_model(resources, order(resources, first_photo), None).row.status == "queued"
    )  # it is not made yet
    finished(resources, first.id, b"tree")
    again = [order(resources, first_photo, name="Twin"), order(resources, same_photo)]
    assert [stored_models.accept_model(resources, one, None).row.status for one in again] == ["succeeded"] * 2
    other = [
        order(resources, first_photo, seed=1),
        order(resources, first_photo, settings={}),
        order(resources, other_photo),
    ]
    assert [stored_models.accept_model(resources, one, None).row.status for one in other] == ["queued"] * 3


def test_a_model_that_another_engine_grew_is_grown_anew(resources: Resources) -> None:
    """As in a data folder that outlives an upgrade, or where a worker is of another version than the web process."""
    photo = photos.add_photo(resources, drawn.encoded()).id
    first = stored_models.accept_model(resources, order(resources, photo), "key").row
    assert first.engine == engine_version()
    finished(resources, first.id, b"tree", by="treestroke 0.1.0+other")
    assert stored_models.find_model(resources.database, first.id).row.engine == "treestroke 0.1.0+other"
    assert stored_models.accept_model(resources, order(resources, photo), None).row.status == "queued"
    # What is sent again is the same request, whoever grew it.
    assert stored_models.accept_model(resources, order(resources, photo), "key").row.id == first.id


@pytest.mark.parametrize("harm", ["flip", "remove"])
def test_a_model_whose_files_are_damaged_is_no_answer_and_growing_it_anew_mends_it(
    resources: Resources, harm: str
) -> None:
    photo = photos.add_photo(resources, drawn.encoded()).id
    first = stored_models.accept_model(resources, order(resources, photo), None).row
    finished(resources, first.id, b"tree")
    blob = stored_models.find_model(resources.database, first.id).files["tree.glb"].blob
    place = resources.blobs.path(blob)
    place.write_bytes(b"tref") if harm == "flip" else place.unlink()
    second = stored_models.accept_model(resources, order(resources, photo), None).row
    assert second.status == "queued"
    finished(resources, second.id, b"tree")
    assert stored_models.accept_model(resources, order(resources, photo), None).row.status == "succeeded"
    assert resources.blobs.get(blob) == b"tree"


def test_a_request_with_a_damaged_photo_is_refused_and_uploading_it_again_mends_it(resources: Resources) -> None:
    photo = photos.add_photo(resources, drawn.encoded(seed=7))
    resources.blobs.path(photo.blob).write_bytes(b"no photo")
    with pytest.raises(Damaged):
        stored_models.accept_model(resources, order(resources, photo.id), None)
    with pytest.raises(Damaged):
        photos.trace_photo(resources, photo.id, json.dumps(drawn.STROKES).encode())
    assert count(resources, ModelRow) == 0
    assert photos.add_photo(resources, drawn.encoded(seed=7)).blob == photo.blob
    assert stored_models.accept_model(resources, order(resources, photo.id), None).row.status == "queued"


def test_a_model_with_the_files_of_a_deleted_one_keeps_them(resources: Resources) -> None:
    photo = photos.add_photo(resources, drawn.encoded()).id
    first = stored_models.accept_model(resources, order(resources, photo), None).row
    finished(resources, first.id, b"tree")
    stored_models.delete(resources.database, first.id)
    seen = stored_models.accept_model(resources, order(resources, photo), None)
    assert resources.blobs.get(seen.files["tree.glb"].blob) == b"tree"


def test_a_photo_that_came_along_is_kept_with_its_model_alone(resources: Resources) -> None:
    good = order(resources, "")
    seen = stored_models.accept_model(resources, good, "key", photos.store_pixels(resources, drawn.encoded()))
    assert photos.get_photo(resources, seen.row.photo)
    stored_models.accept_model(resources, good, "key", photos.store_pixels(resources, drawn.encoded()))
    beside = {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}
    bad = model_request.read_form({"strokes": json.dumps(beside).encode()})
    with pytest.raises(StrokesError):
        stored_models.accept_model(resources, bad, None, photos.store_pixels(resources, drawn.encoded()))
    assert (count(resources, PhotoRow), count(resources, ModelRow)) == (1, 1)


def test_a_key_that_outlived_its_model_gives_a_new_one(resources: Resources) -> None:
    photo = photos.add_photo(resources, drawn.encoded()).id
    first = stored_models.accept_model(resources, order(resources, photo), "key").row.id
    with resources.database.writing() as session:
        session.query(ModelRow).delete()
    second = stored_models.accept_model(resources, order(resources, photo), "key").row.id
    assert second != first
    assert stored_models.accept_model(resources, order(resources, photo), "key").row.id == second


def test_a_model_of_sketches_needs_no_photo_and_is_known_again(resources: Resources) -> None:
    asked = json.dumps(sketched.request(seed=3)).encode()
    model = stored_models.accept_model(resources, model_request.read_order(asked), "key")
    assert (model.row.photo, model.inputs.source, list(model.parts)) == (None, "sketches", ["front", "side"])
    assert list(model.drawings) == ["front.json", "side.json"]
    first = model.row
    assert stored_models.accept_model(resources, model_request.read_order(asked), "key").row.id == first.id
    finished(resources, first.id, b"tree")
    assert stored_models.accept_model(resources, model_request.read_order(asked), None).row.status == "succeeded"
    exchanged = {"front": sketched.SIDE, "side": sketched.FRONT}
    for change in ({"seed": 4}, {"sketches": exchanged}, {"sketches": {"front": sketched.FRONT}}):
        other = model_request.read_order(json.dumps(sketched.request(**{"seed": 3, **change})).encode())
        assert stored_models.accept_model(resources, other, None).row.status == "queued"
        with pytest.raises(KeyReused):
            stored_models.accept_model(resources, other, "key")


def test_the_same_strokes_with_another_side_are_another_model(resources: Resources) -> None:
    photo = photos.add_photo(resources, drawn.encoded()).id
    models = [
        stored_models.accept_model(resources, order(resources, photo, **more), None)
        for more in ({}, {"sketches": {"side": sketched.SIDE}}, {"sketches": {"side": sketched.FRONT}})
    ]
    assert len({model.row.fingerprint for model in models}) == 3
    assert [list(model.drawings) for model in models] == [["strokes.json"], *[["strokes.json", "side.json"]] * 2]


def test_a_model_that_there_is_not_is_not_found(resources: Resources) -> None:
    for ask in (stored_models.find_model, stored_models.cancel, stored_models.delete, stored_models.restore):
        with pytest.raises(NotFound):
            ask(resources.database, "mdl_0")
    with pytest.raises(NotFound):
        stored_models.change(resources.database, "mdl_0", {"name": "x"})


@contextmanager
def questions() -> Iterator[list[str]]:
    """Collect what the database is asked."""
    asked: list[str] = []

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        asked.append(statement)

    event.listen(Engine, "before_cursor_execute", note)
    try:
        yield asked
    finally:
        event.remove(Engine, "before_cursor_execute", note)


def test_many_models_are_shown_with_as_few_questions_as_one(database: Database) -> None:
    counts = []
    for _ in range(2):
        add_model(database, status="running")
        rows = [add_model(database) for _ in range(10)]
        with questions() as page:
            stored_models.list_models(database, None, 50)
        with questions() as change:
            stored_models.find_changed(database, dict.fromkeys([row.id for row in rows]))
        counts.append((len(page), len(change)))
    assert counts[0] == counts[1]
    assert max(counts[0]) < 10


def test_only_what_changed_is_shown_anew(database: Database) -> None:
    rows = [add_model(database) for _ in range(3)]
    versions = {row.id: stored_models.find_model(database, row.id).version for row in rows}
    assert stored_models.find_changed(database, versions) == {}
    stored_models.change(database, rows[0].id, {"name": "Oak"})
    stored_models.cancel(database, rows[1].id)  # the third moves up
    changed = stored_models.find_changed(database, {**versions, "mdl_gone": None})
    assert changed.keys() == {rows[0].id, rows[1].id, rows[2].id, "mdl_gone"}
    assert changed["mdl_gone"] is None
    third = changed[rows[2].id]
    assert third is not None
    assert third.queue_position == 2
