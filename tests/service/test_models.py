import base64
import json
from typing import Any

import pytest
from tests.api import drawn, sketched

from treestroke.codec.project import read_project
from treestroke.core.errors import StrokesError
from treestroke.service import models, photos
from treestroke.service.engine import engine
from treestroke.service.models import KeyReused
from treestroke.service.photos import NotFound, Shelf
from treestroke.service.wishes import Wish
from treestroke.store.blobs import Damaged
from treestroke.store.leases import claim, succeed
from treestroke.store.tables import Model, Photo


def wish(shelf: Shelf, photo: str, **others: Any) -> Wish:
    return models.read_wish(shelf, json.dumps(drawn.wish(photo, **others)).encode())


def finished(shelf: Shelf, id: str, glb: bytes, by: str = "") -> None:
    """Publish a model as its worker does."""
    with shelf.database.writing() as session:
        job = claim(session, id, "t", "w", by or engine())
        assert job is not None
        assert succeed(session, job, {"score": {}}, {"tree.glb": (shelf.blobs.put(glb), len(glb))})


def count(shelf: Shelf, table: type[Model] | type[Photo]) -> int:
    with shelf.database.reading() as session:
        return session.query(table).count()


def test_a_model_is_answered_from_one_of_the_same_input_alone(shelf: Shelf) -> None:
    first_photo, same_photo, other_photo = (photos.add_photo(shelf, drawn.encoded(seed=seed)).id for seed in (0, 0, 1))
    first = models.ask_for_model(shelf, wish(shelf, first_photo), None).row
    assert models.ask_for_model(shelf, wish(shelf, first_photo), None).row.status == "queued"  # it is not made yet
    finished(shelf, first.id, b"tree")
    again = [wish(shelf, first_photo, name="Twin"), wish(shelf, same_photo)]
    assert [models.ask_for_model(shelf, one, None).row.status for one in again] == ["succeeded"] * 2
    other = [wish(shelf, first_photo, seed=1), wish(shelf, first_photo, settings={}), wish(shelf, other_photo)]
    assert [models.ask_for_model(shelf, one, None).row.status for one in other] == ["queued"] * 3


def test_a_model_that_another_engine_grew_is_grown_anew(shelf: Shelf) -> None:
    """As in a data folder that outlives an upgrade, or where a worker is of another version than the web process."""
    photo = photos.add_photo(shelf, drawn.encoded()).id
    first = models.ask_for_model(shelf, wish(shelf, photo), "key").row
    assert first.engine == engine()
    finished(shelf, first.id, b"tree", by="treestroke 0.1.0+other")
    assert models.see(shelf.database, first.id).row.engine == "treestroke 0.1.0+other"
    assert models.ask_for_model(shelf, wish(shelf, photo), None).row.status == "queued"
    # What is sent again is the same request, whoever grew it.
    assert models.ask_for_model(shelf, wish(shelf, photo), "key").row.id == first.id


@pytest.mark.parametrize("harm", ["flip", "remove"])
def test_a_model_whose_files_are_damaged_is_no_answer_and_growing_it_anew_mends_it(shelf: Shelf, harm: str) -> None:
    photo = photos.add_photo(shelf, drawn.encoded()).id
    first = models.ask_for_model(shelf, wish(shelf, photo), None).row
    finished(shelf, first.id, b"tree")
    blob = models.see(shelf.database, first.id).files["tree.glb"].blob
    place = shelf.blobs.path(blob)
    place.write_bytes(b"tref") if harm == "flip" else place.unlink()
    second = models.ask_for_model(shelf, wish(shelf, photo), None).row
    assert second.status == "queued"
    finished(shelf, second.id, b"tree")
    assert models.ask_for_model(shelf, wish(shelf, photo), None).row.status == "succeeded"
    assert shelf.blobs.get(blob) == b"tree"


def test_a_request_with_a_damaged_photo_is_refused_and_uploading_it_again_mends_it(shelf: Shelf) -> None:
    photo = photos.add_photo(shelf, drawn.encoded(seed=7))
    shelf.blobs.path(photo.blob).write_bytes(b"no photo")
    with pytest.raises(Damaged):
        models.ask_for_model(shelf, wish(shelf, photo.id), None)
    with pytest.raises(Damaged):
        photos.trace_photo(shelf, photo.id, json.dumps(drawn.STROKES).encode())
    assert count(shelf, Model) == 0
    assert photos.add_photo(shelf, drawn.encoded(seed=7)).blob == photo.blob
    assert models.ask_for_model(shelf, wish(shelf, photo.id), None).row.status == "queued"


def test_a_model_of_a_deleted_twin_keeps_the_files(shelf: Shelf) -> None:
    photo = photos.add_photo(shelf, drawn.encoded()).id
    first = models.ask_for_model(shelf, wish(shelf, photo), None).row
    finished(shelf, first.id, b"tree")
    models.delete(shelf.database, first.id)
    seen = models.ask_for_model(shelf, wish(shelf, photo), None)
    assert shelf.blobs.get(seen.files["tree.glb"].blob) == b"tree"


def test_a_photo_that_came_along_is_kept_with_its_model_alone(shelf: Shelf) -> None:
    good = wish(shelf, "")
    seen = models.ask_for_model(shelf, good, "key", photos.take_in(shelf, drawn.encoded()))
    assert photos.get_photo(shelf, seen.row.photo)
    models.ask_for_model(shelf, good, "key", photos.take_in(shelf, drawn.encoded()))
    beside = {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}
    bad = models.read_fields(shelf, {"strokes": json.dumps(beside).encode()})
    with pytest.raises(StrokesError):
        models.ask_for_model(shelf, bad, None, photos.take_in(shelf, drawn.encoded()))
    assert (count(shelf, Photo), count(shelf, Model)) == (1, 1)


def test_a_key_that_outlived_its_model_gives_a_new_one(shelf: Shelf) -> None:
    photo = photos.add_photo(shelf, drawn.encoded()).id
    first = models.ask_for_model(shelf, wish(shelf, photo), "key").row.id
    with shelf.database.writing() as session:
        session.query(Model).delete()
    second = models.ask_for_model(shelf, wish(shelf, photo), "key").row.id
    assert second != first
    assert models.ask_for_model(shelf, wish(shelf, photo), "key").row.id == second


def test_a_project_is_photo_strokes_and_settings_whole(shelf: Shelf) -> None:
    photo = photos.add_photo(shelf, drawn.encoded())
    row = models.ask_for_model(shelf, wish(shelf, photo.id, seed=7), None).row
    _, blob = models.project_of(shelf, row.id)
    project = read_project(shelf.blobs.get(blob), "x")
    assert project.photo == shelf.blobs.get(photo.blob)
    assert json.loads(project.strokes) == {**drawn.STROKES, "erase": []}
    assert project.settings == {**row.settings, "seed": 7}
    assert models.project_of(shelf, row.id)[1] == blob


def test_a_model_of_sketches_needs_no_photo_and_is_known_again(shelf: Shelf) -> None:
    asked = json.dumps(sketched.wish(seed=3)).encode()
    first = models.ask_for_model(shelf, models.read_wish(shelf, asked), "key").row
    assert (first.photo, first.photo_blob, first.strokes_blob) == (None, None, None)
    assert list(first.drawings) == ["front.json", "side.json"]
    assert models.ask_for_model(shelf, models.read_wish(shelf, asked), "key").row.id == first.id
    finished(shelf, first.id, b"tree")
    assert models.ask_for_model(shelf, models.read_wish(shelf, asked), None).row.status == "succeeded"
    exchanged = {"front": sketched.SIDE, "side": sketched.FRONT}
    for change in ({"seed": 4}, {"sketches": exchanged}, {"sketches": {"front": sketched.FRONT}}):
        other = models.read_wish(shelf, json.dumps(sketched.wish(**{"seed": 3, **change})).encode())
        assert models.ask_for_model(shelf, other, None).row.status == "queued"
        with pytest.raises(KeyReused):
            models.ask_for_model(shelf, other, "key")


def test_the_same_strokes_with_another_side_are_another_model(shelf: Shelf) -> None:
    photo = photos.add_photo(shelf, drawn.encoded()).id
    rows = [
        models.ask_for_model(shelf, wish(shelf, photo, **more), None).row
        for more in ({}, {"sketches": {"side": sketched.SIDE}}, {"sketches": {"side": sketched.FRONT}})
    ]
    assert len({row.fingerprint for row in rows}) == 3
    assert [list(row.drawings) for row in rows] == [["strokes.json"], *[["strokes.json", "side.json"]] * 2]


def test_a_project_of_sketches_holds_them_as_they_were_sent(shelf: Shelf) -> None:
    sketches = {"front": sketched.FRONT, "side": sketched.pictured(sketched.SIDE)}
    fruit = base64.b64encode(sketched.berry()).decode()
    asked = models.read_wish(shelf, json.dumps(sketched.wish(sketches=sketches, fruit=fruit)).encode())
    row = models.ask_for_model(shelf, asked, None).row
    assert list(row.drawings) == ["front.json", "side.png"]
    project = read_project(shelf.blobs.get(models.project_of(shelf, row.id)[1]), "x")
    assert (project.photo, project.strokes, project.leaf, project.fruit) == (None, None, None, sketched.berry())
    assert json.loads(project.front or b"") == sketched.FRONT
    assert (project.side or b"").startswith(b"\x89PNG")


def test_a_model_that_there_is_not_is_not_found(shelf: Shelf) -> None:
    for ask in (models.see, models.cancel, models.delete, models.restore):
        with pytest.raises(NotFound):
            ask(shelf.database, "mdl_0")
    with pytest.raises(NotFound):
        models.rename(shelf.database, "mdl_0", "x")
