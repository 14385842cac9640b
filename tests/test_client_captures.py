"""The client's calls about captures against a real service, which is not asked to find cameras more than once."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests import walked_capture
from tests.engines.rendered_set import photos_of, ring
from tests.running import serving

from treestroke.capture_schemas import CaptureInfo
from treestroke.client import Client, ServiceError
from treestroke.codec.image import encode_png
from treestroke.wire_strokes import CaptureStrokes

PATIENCE_SECONDS = 600
"""Emergency exit of what is waited for."""


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("service") / "data"


@pytest.fixture(scope="module")
def client(data: Path) -> Iterator[Client]:
    with serving(data, tracers=1) as address, Client(address) as client:
        yield client


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the photos of a small tree, and a file that is none."""
    folder = tmp_path_factory.mktemp("walk")
    for name, shot in zip(walked_capture.names(), walked_capture.shots(), strict=True):
        (folder / name).write_bytes(encode_png(shot.picture))
    (folder / "notes.txt").write_text("an oak")
    return folder


@pytest.fixture(scope="module")
def capture(client: Client, data: Path, folder: Path) -> CaptureInfo:
    """A solved capture of that tree."""
    made = client.make_capture("Oak")
    client.add_photos(made, folder)
    walked_capture.write_structure_in(data, made.id, walked_capture.structure())
    return client.capture(made)


def test_a_folder_of_photos_goes_up_in_the_order_of_its_names_and_once(client: Client, folder: Path) -> None:
    made = client.make_capture()
    added = client.add_photos(made, folder)
    assert [photo.name for photo in added] == sorted(walked_capture.names())
    assert client.add_photos(made, sorted(folder.glob("*.png"))[:2]) == added[:2]
    assert [photo.name for photo in client.capture(made).photos] == sorted(walked_capture.names())
    client.delete_capture(made)


def test_a_capture_is_named_deleted_and_restored(client: Client) -> None:
    made = client.make_capture("Oak")
    assert client.rename_capture(made, "Ash").name == "Ash"
    client.delete_capture(made)
    with pytest.raises(ServiceError, match="there is no such capture"):
        client.capture(made)
    assert client.restore_capture(made.id).name == "Ash"
    assert made.id in {one.id for one in client.captures()}


def test_a_solved_capture_is_traced_and_becomes_a_tree(client: Client, capture: CaptureInfo) -> None:
    assert (capture.status, len(capture.cameras)) == ("solved", walked_capture.COUNT)
    drawn = walked_capture.views()
    found = client.trace_capture(capture, drawn, rev=4)
    assert (found.rev, found.grown) == (4, None)
    assert [photo.photo for photo in found.photos] == walked_capture.names()
    edits = [{"do": "remove", "at": list(found.skeleton.points[-1])}]
    edited = client.trace_capture(capture, CaptureStrokes.model_validate(drawn), edits, grow=True)
    assert len(edited.skeleton.points) < len(found.skeleton.points)
    assert edited.grown is not None
    model = client.grow_capture(capture, drawn, edits, walked_capture.SETTINGS, name="Walked")
    model = client.wait(model, timeout=PATIENCE_SECONDS)
    assert (model.status, model.name, model.capture) == ("succeeded", "Walked", capture.id)
    assert "edits.json" in model.files


def test_cameras_are_found_and_waited_for(client: Client, tmp_path: Path) -> None:
    for number, photo in enumerate(photos_of(ring(6, 60.0))):
        (tmp_path / f"{number}.png").write_bytes(encode_png(photo.picture))
    made = client.make_capture()
    with pytest.raises(ServiceError, match="at least 5 are needed"):
        client.solve(made)
    client.add_photos(made, tmp_path)
    seen: list[str] = []
    with pytest.raises(TimeoutError, match="not finished yet"):
        client.solve(made, timeout=0.01)
    solved = client.solve(made, PATIENCE_SECONDS, lambda now: seen.append(now.status))
    assert (solved.status, seen[-1]) == ("solved", "solved")
    assert len(solved.cameras) == 6
    assert client.cancel_solve(made).status == "solved"
