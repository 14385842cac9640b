import io
import json
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from tests import walked_capture
from tests.rows import claim
from tests.structures import small_structure
from tests.walked_capture import COUNT, UNUSED, make_capture, names, request, solve, structure, views, write_structure

from treestroke.codec.project import read_project
from treestroke.codec.structure import encode_structure
from treestroke.core.errors import CaptureError, StrokesError, TreestrokeError
from treestroke.service import captures, model_request, stored_models
from treestroke.service.capture_photos import warnings_of
from treestroke.service.jobs import grow_model
from treestroke.service.model import Options, make_tree
from treestroke.service.photos import NotFound, Resources
from treestroke.service.projects import Projects
from treestroke.service.stored_models import KeyReused, StoredModel
from treestroke.store.queries import referenced
from treestroke.store.tables import CapturePhoto

PATIENCE_SECONDS = 300
EDITS = [
    {"do": "add", "from": [0.0, 2.0, 0.0], "points": [[0.5, 2.4, 0.3], [1.0, 3.0, 0.4]]},
    {"do": "remove", "at": [90.0, 0.0, 0.0]},
]
"""A branch of the small tree, and an edit of nothing."""
ELSE = [f"{index}.png" for index in range(1, 6)]


@pytest.fixture
def capture(resources: Resources) -> str:
    """A solved capture, one of whose photos is not used."""
    id = make_capture(resources)
    solve(resources, id)
    return id


@pytest.fixture
def projects(resources: Resources) -> Iterator[Projects]:
    made = Projects(resources.blobs, resources.tracers)
    yield made
    made.close()


def ask(resources: Resources, key: str | None = None, **wish: Any) -> StoredModel:
    order = model_request.read_order(json.dumps(wish).encode())
    return stored_models.accept_model(resources, order, key)


def grown(resources: Resources, model: StoredModel) -> StoredModel:
    """Grow a model as its worker does."""
    grow_model(resources.database, resources.blobs, claim(resources.database, model.row), PATIENCE_SECONDS)
    return stored_models.find_model(resources.database, model.id)


def test_a_model_shares_the_files_of_its_capture(resources: Resources, capture: str) -> None:
    stored = captures.find_capture(resources.database, capture)
    blobs_before = sum(path.is_file() for path in (resources.blobs.data / "blobs").rglob("*"))
    model = ask(resources, **request(capture, name="Around"))
    assert set(model.parts) == {*(f"photos/{name}" for name in [*names(), UNUSED]), "views", "structure"}
    assert {f"photos/{photo.name}": photo.blob for photo in stored.photos}.items() <= {
        name: part.blob for name, part in model.parts.items()
    }.items()
    assert stored.solve is not None
    assert model.parts["structure"].blob == stored.solve.structure
    assert (
        sum(path.is_file() for path in (resources.blobs.data / "blobs").rglob("*")) == blobs_before + 1
    )  # the strokes
    assert (model.row.capture, model.row.photo, model.row.name) == (capture, None, "Around")
    assert list(model.drawings) == ["views.json"]
    assert list(ask(resources, **request(capture, edits=[])).drawings) == ["views.json"]
    assert list(ask(resources, **request(capture, edits=EDITS)).drawings) == ["views.json", "edits.json"]


def test_a_capture_becomes_a_tree_and_its_project_makes_the_same_tree(
    resources: Resources, capture: str, projects: Projects
) -> None:
    """The longest of this file: two whole trees are made, of edited branches."""
    model = ask(resources, **request(capture, edits=EDITS))
    captures.delete(resources.database, capture)
    with resources.database.writing() as session:
        for photo in session.query(CapturePhoto).all():
            session.delete(photo)  # as when the day is over
    kept = {part.blob for part in model.parts.values()}
    with resources.database.reading() as session:
        assert kept <= referenced(session)
    after = grown(resources, model)
    assert (after.row.status, after.row.error) == ("succeeded", None)
    report = after.row.report
    assert report is not None
    assert [camera["photo"] for camera in report["cameras"]] == names()
    assert report["registered"] == {"used": COUNT, "of": COUNT + 1}
    assert {"decode", "mattes", "hull", "density", "points", "branches", "grow", "leaf"} <= set(report["seconds"])
    assert {(warning["code"], warning["stroke"]) for warning in report["warnings"]} >= {
        ("same_photo", f"photos/{UNUSED}"),
        ("edit_lost", "edits/1"),
    }
    packed = projects.pack(after).result(PATIENCE_SECONDS).path.read_bytes()
    project = read_project(io.BytesIO(packed), "around.treestroke")
    assert json.loads(project.inputs.parts["edits"]) == {"edits": EDITS}
    options = Options.of({key: value for key, value in project.settings.items() if key != "seed"}, 0)
    made = make_tree(project.inputs, options)
    assert made.glb == resources.blobs.get(after.files["tree.glb"].blob)
    assert made.report["cameras"] == report["cameras"]


def test_what_was_mended_in_a_photo_is_told_by_its_name(resources: Resources, capture: str) -> None:
    with resources.database.writing() as session:
        row = session.query(CapturePhoto).filter_by(capture=capture, name="3.png").one()
        row.warnings = [{"code": "photo_cut_short", "stroke": "photo", "detail": "the rest is grey"}]
    photos = captures.find_capture(resources.database, capture).photos
    assert warnings_of(photos) == [{"code": "photo_cut_short", "stroke": "photos/3.png", "detail": "the rest is grey"}]
    plain = ask(resources, **request(make_solved(resources)))
    assert ask(resources, **request(capture)).row.fingerprint != plain.row.fingerprint


def make_solved(resources: Resources) -> str:
    id = make_capture(resources)
    solve(resources, id)
    return id


def test_the_same_photos_and_strokes_are_one_tree_whichever_capture_has_them(
    resources: Resources, capture: str
) -> None:
    first, second = ask(resources, **request(capture)), ask(resources, **request(make_solved(resources)))
    assert first.row.fingerprint == second.row.fingerprint
    others = [
        request(capture, seed=1),
        request(capture, edits=EDITS),
        request(capture, views=views(scale={"photos": names()[:2], "metres": 3.0})),
    ]
    assert len({ask(resources, **other).row.fingerprint for other in others} | {first.row.fingerprint}) == 4


def test_a_request_sent_again_is_the_same_model_though_the_capture_has_changed(
    resources: Resources, capture: str
) -> None:
    first = ask(resources, "key", **request(capture))
    captures.remove_photo(resources.database, capture, captures.find_capture(resources.database, capture).photos[0].id)
    assert ask(resources, "key", **request(capture)).id == first.id
    captures.delete(resources.database, capture)
    assert ask(resources, "key", **request(capture)).id == first.id
    with pytest.raises(KeyReused):
        ask(resources, "key", **request(capture, seed=2))


def test_a_capture_is_solved_first(resources: Resources) -> None:
    id = make_capture(resources)
    for status in ("unsolved", "queued"):
        with pytest.raises(
            CaptureError, match=f"^capture: its cameras are not known, it is {status}; solve"
        ) as refused:
            ask(resources, **request(id))
        assert (refused.value.code, refused.value.pointer) == ("capture_unsolved", "/capture")
        captures.solve(resources, id)


def test_a_capture_that_is_not_there_makes_no_model(resources: Resources, capture: str) -> None:
    with pytest.raises(NotFound, match="capture"):
        ask(resources, **request("cap_" + "0" * 24))
    captures.delete(resources.database, capture)
    with pytest.raises(NotFound, match="capture"):
        ask(resources, **request(capture))


def over(name: str, **others: Any) -> dict[str, Any]:
    """Draw what is drawn over the first photo over another one."""
    return views(views=[{**views()["views"][0], "photo": name, **others}])


@pytest.mark.parametrize(
    ("drawn", "code", "pointer"),
    [
        (partial(over, "IMG_9.jpg"), "photo_unknown", "/views/views/0/photo"),
        (partial(over, UNUSED), "photo_not_used", "/views/views/0/photo"),
        (partial(over, "0.png", branches=[]), "trunk_missing", "/views/views/0/branches"),
        (partial(over, "0.png", crown={"points": [[0, 0], [0, 0], [0, 0]]}), None, "/views/views/0/crown"),
        (partial(views, views=[views()["views"][0]] * 2), "photo_twice", "/views/views/1/photo"),
        (
            partial(views, scale={"photos": ["0.png", "IMG_9.jpg"], "metres": 2.0}),
            *("photo_unknown", "/views/scale/photos/1"),
        ),
        (
            partial(views, scale={"photo": UNUSED, "points": [[1, 1], [9, 9]], "metres": 2.0}),
            *("photo_not_used", "/views/scale/photo"),
        ),
    ],
)
def test_strokes_that_the_photos_cannot_carry_are_refused(
    resources: Resources, capture: str, drawn: Any, code: str | None, pointer: str
) -> None:
    with pytest.raises(StrokesError) as refused:
        ask(resources, **request(capture, views=drawn()))
    assert (code or refused.value.code, refused.value.pointer) == (refused.value.code, pointer)


@pytest.mark.parametrize(
    ("wish", "code", "pointer"),
    [
        ({"capture": "cap_1"}, "missing_key", "/views"),
        ({"views": views()}, "missing_key", "/capture"),
        ({"edits": []}, "missing_key", "/capture"),
        ({"capture": "cap_1", "edits": []}, "missing_key", "/views"),
        ({"capture": "cap_1", "views": views(), "edits": [{}]}, "edit_unknown", "/edits/0"),
        ({"capture": 1, "views": views()}, "wrong_type", "/capture"),
        ({"capture": "cap_1", "views": views(), "photo": "pho_1"}, "strokes_and_sketch", "/photo"),
        ({"capture": "cap_1", "views": views(), "sketches": {}}, "strokes_and_sketch", "/sketches"),
        ({"capture": "cap_1", "views": {"views": []}}, "wrong_type", "/views/views"),
        ({"capture": "cap_1", "views": {**views(), "photo": "0.png"}}, "unknown_key", "/views/photo"),
    ],
)
def test_what_a_capture_does_not_go_with_is_refused(wish: dict[str, Any], code: str, pointer: str) -> None:
    with pytest.raises(TreestrokeError) as refused:
        model_request.read_order(json.dumps(wish).encode())
    assert (refused.value.code, refused.value.pointer) == (code, pointer)


def test_the_cameras_of_other_photos_are_no_cameras_of_this_capture(resources: Resources, capture: str) -> None:
    """A structure names its photos: strokes over one that it does not have are refused."""
    other = captures.make_capture(resources.database, b"").id
    for name in ELSE:
        captures.add_photo(resources, other, name, walked_capture.encode_png(walked_capture.shots()[0].picture))
    write_structure(resources.database, resources.blobs, other, small_structure(ELSE))
    with pytest.raises(StrokesError, match=r"there is no photo 0\.png") as refused:
        ask(resources, **request(other))
    assert refused.value.code == "photo_unknown"


def test_strokes_over_a_capture_come_back_as_they_were(resources: Resources, capture: str) -> None:
    model = ask(resources, **request(capture))
    assert json.loads(resources.blobs.get(model.parts["views"].blob)) == views()
    assert resources.blobs.get(model.parts["structure"].blob) == encode_structure(structure())
    assert np.allclose(views()["scale"]["metres"], 20.0)
