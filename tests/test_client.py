"""The client against a real service, through connections that break, and against servers that are none of ours."""

import hashlib
import http.server
import json
import select
import socket
import socketserver
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.api import drawn, sketched
from tests.running import BACKEND, serving

from treestroke import client_connection
from treestroke.client import Client, ServiceError
from treestroke.schemas import ModelInfo, PhotoInfo
from treestroke.wire_strokes import Sketch, Strokes

DATA = Path(__file__).parent / "data"
PHOTO, STROKES = DATA / "elm_house.jpg", DATA / "elm_house.strokes.json"
QUICK = {"iterations": 20}
WHOLE = 2**60
PATIENCE_SECONDS = 300
"""Emergency exit of what is waited for."""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with serving(tmp_path_factory.mktemp("service") / "data") as address:
        yield address


@pytest.fixture(scope="module")
def client(address: str) -> Iterator[Client]:
    with Client(address) as client:
        yield client


@pytest.fixture(scope="module")
def photo(client: Client) -> PhotoInfo:
    return client.upload(PHOTO)


@pytest.fixture(scope="module")
def tree(client: Client, photo: PhotoInfo) -> ModelInfo:
    return client.wait(client.grow(photo, STROKES, QUICK, name="Elm"), timeout=PATIENCE_SECONDS)


@contextmanager
def through(address: str, cut: Callable[[bytes], int]) -> Iterator[str]:
    """Stand before the service; ``cut`` says of a request after how many bytes of its answer the line breaks."""
    host, _, port = address.removeprefix("http://").partition(":")

    class Line(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            left = WHOLE
            with socket.create_connection((host, int(port))) as service:
                while left > 0:
                    for side in select.select([self.request, service], [], [])[0]:
                        content = side.recv(4096)
                        if not content:
                            return
                        if side is service:
                            self.request.sendall(content[:left])
                            left -= len(content)
                        else:
                            left = cut(content) if content.startswith((b"GET ", b"POST ")) else left
                            service.sendall(content)

    with answering(socketserver.ThreadingTCPServer(("127.0.0.1", 0), Line)) as place:
        yield place


@contextmanager
def answering(server: socketserver.ThreadingTCPServer) -> Iterator[str]:
    server.daemon_threads = True
    server.handle_error = lambda *_: None  # type: ignore[method-assign]
    with server:
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()
        thread.join()


@contextmanager
def saying(*answers: tuple[int, dict[str, str], bytes]) -> Iterator[str]:
    """Be another server, which gives these answers, the last one for ever."""
    waiting = list(answers)

    class Other(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            status, headers, body = waiting.pop(0) if len(waiting) > 1 else waiting[0]
            self.send_response(status)
            for name, value in {**headers, "Content-Length": str(len(body))}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with answering(http.server.ThreadingHTTPServer(("127.0.0.1", 0), Other)) as place:
        yield place


def breaking(times: int, after: int, path: bytes) -> Callable[[bytes], int]:
    """Break the first ``times`` answers to a path after so many bytes."""
    left = [times]

    def cut(request: bytes) -> int:
        if path not in request.split(b"\r\n", 1)[0] or not left[0]:
            return WHOLE
        left[0] -= 1
        return after

    return cut


def test_a_photo_is_uploaded_from_a_path_and_from_bytes(client: Client, photo: PhotoInfo) -> None:
    again = client.upload(PHOTO.read_bytes())
    assert (again.width, again.height) == (photo.width, photo.height) == (450, 600)
    assert again.sha256 == photo.sha256 == hashlib.sha256(PHOTO.read_bytes()).hexdigest()
    client.delete_photo(again)
    with pytest.raises(ServiceError, match="there is no such photo"):
        client.photo(again)


def test_photos_are_given_over_pages(client: Client, photo: PhotoInfo) -> None:
    added = [client.upload(drawn.encoded()) for _ in range(25)]
    given = list(client.photos())
    assert given[:25] == added[::-1]
    assert photo in given
    for one in added:
        client.delete_photo(one)


def test_strokes_are_a_path_a_mapping_or_values(client: Client, photo: PhotoInfo) -> None:
    plain = json.loads(STROKES.read_text())
    found = [client.trace(photo, strokes, rev=7) for strokes in (STROKES, plain, Strokes.model_validate(plain))]
    assert found[0] == found[1] == found[2]
    assert found[0].rev == 7
    assert found[0].grown is None


def test_a_trace_grows_the_whole_skeleton(client: Client, photo: PhotoInfo) -> None:
    found = client.trace(photo, STROKES, grow=True)
    assert found.grown is not None
    assert len(found.grown.points) > len(found.skeleton.points) > 0
    other = client.trace(photo, STROKES, grow=True, settings={"iterations": 0})
    assert other.grown is not None
    assert len(other.grown.points) < len(found.grown.points)
    assert other.taken == found.taken
    assert found.taken is not None


def test_a_tree_is_followed_to_its_end(client: Client, photo: PhotoInfo) -> None:
    seen, previews = [], []
    model = client.grow(photo, STROKES, QUICK, seed=1)
    ended = client.wait(model, timeout=PATIENCE_SECONDS, on_progress=seen.append, on_preview=previews.append)
    assert ended.status == "succeeded"
    assert len(previews) == 1
    assert [now.progress for now in seen] == sorted(now.progress for now in seen)
    assert seen[-1] == ended


def test_waiting_for_what_is_finished_ends_at_once(client: Client, tree: ModelInfo) -> None:
    assert client.wait(tree.id, timeout=PATIENCE_SECONDS) == client.model(tree)


def test_a_file_arrives_whole(client: Client, tree: ModelInfo, tmp_path: Path) -> None:
    place = client.download(tree, tmp_path / "elm.glb")
    client.download(tree, tmp_path / "elm.png", "preview.png")
    assert place.read_bytes()[:4] == b"glTF"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["elm.glb", "elm.png"]


def test_a_file_that_there_is_not_leaves_nothing(client: Client, tree: ModelInfo, tmp_path: Path) -> None:
    (tmp_path / "elm.glb").write_bytes(b"older")
    with pytest.raises(ServiceError) as caught:
        client.download(tree, tmp_path / "elm.glb", "leaf.glb")
    assert caught.value.status == 404
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"older"]


def test_a_model_is_named_deleted_and_restored(client: Client, tree: ModelInfo) -> None:
    assert client.rename(tree, "Old elm").name == "Old elm"
    client.delete(tree)
    with pytest.raises(ServiceError) as caught:
        client.model(tree)
    assert (caught.value.status, caught.value.code) == (404, "model_not_found")
    assert client.restore(tree).name == "Old elm"


def test_siblings_of_a_model_are_files_of_another(client: Client, tree: ModelInfo, tmp_path: Path) -> None:
    more = client.wait(client.siblings(tree, 1, envelope="circle", name="Round"), timeout=PATIENCE_SECONDS)
    assert (more.status, more.name) == ("succeeded", "Round")
    assert client.download(more, tmp_path / "round.glb", "tree.s1.glb").read_bytes().startswith(b"glTF")
    with pytest.raises(ServiceError) as caught:
        client.siblings(tree, 0)
    assert caught.value.status == 422


def test_a_model_is_canceled(client: Client, photo: PhotoInfo) -> None:
    model = client.grow(photo, STROKES, {"iterations": 2000}, seed=2)
    client.cancel(model)
    assert client.wait(model, timeout=PATIENCE_SECONDS).status == "canceled"


def test_models_are_given_over_pages(client: Client, photo: PhotoInfo, tree: ModelInfo) -> None:
    asked = [client.grow(photo, STROKES, tree.settings, name=f"page {number}").id for number in range(25)]
    given = [model.id for model in client.models()]
    assert given[:25] == asked[::-1]
    assert len(set(given)) == len(given) > 25


def test_what_is_refused_names_the_field(client: Client, photo: PhotoInfo) -> None:
    with pytest.raises(ServiceError) as caught:
        client.grow(photo, {"crown": {"points": [[10, 10], [200, 10], [200, 200]]}})
    assert (caught.value.status, caught.value.code) == (422, "trunk_missing")
    assert [fault.pointer for fault in caught.value.errors] == ["/strokes/branches"]


def test_a_request_that_is_cut_off_makes_one_model(address: str, photo: PhotoInfo) -> None:
    with through(address, breaking(2, 0, b"/v1/models")) as place, Client(place) as client:
        made = client.grow(photo, STROKES, QUICK, name="cut off")
        assert [model.id for model in client.models() if model.name == "cut off"] == [made.id]


def test_one_key_gives_one_model(client: Client, photo: PhotoInfo) -> None:
    first, second = (client.grow(photo, STROKES, QUICK, idempotency_key="elm-1") for _ in range(2))
    assert first.id == second.id


def test_a_stream_that_breaks_is_taken_up_again(address: str, photo: PhotoInfo) -> None:
    previews: list[object] = []
    with through(address, breaking(4, 3000, b"/events")) as place, Client(place) as client:
        model = client.grow(photo, STROKES, QUICK, seed=3)
        assert client.wait(model, timeout=PATIENCE_SECONDS, on_preview=previews.append).status == "succeeded"
    assert len(previews) <= 1


def test_without_a_stream_a_model_is_looked_up(address: str, photo: PhotoInfo) -> None:
    with through(address, breaking(WHOLE, 0, b"/events")) as place, Client(place) as client:
        assert client.wait(client.grow(photo, STROKES, QUICK, seed=4), timeout=PATIENCE_SECONDS).status == "succeeded"


def test_a_download_that_breaks_is_made_again(address: str, tree: ModelInfo, tmp_path: Path) -> None:
    with through(address, breaking(1, 50_000, b"/tree.glb")) as place, Client(place) as client:
        whole = client.download(tree, tmp_path / "elm.glb").read_bytes()
    assert len(whole) == int.from_bytes(whole[8:12], "little")


def test_a_tree_is_made_of_sketches_in_any_form(client: Client, tmp_path: Path) -> None:
    picture, text = tmp_path / "front.png", tmp_path / "side.json"
    picture.write_bytes(sketched.png(sketched.FRONT))
    text.write_text(json.dumps(sketched.SIDE))
    model = client.wait(
        client.grow_sketches(picture, text, QUICK, fruit=sketched.berry(), name="Pear"), timeout=PATIENCE_SECONDS
    )
    assert (model.status, model.photo, model.name) == ("succeeded", None, "Pear")
    assert {"front.png", "side.json"} <= set(model.files)
    assert json.loads(client.download(model, tmp_path / "again.json", "side.json").read_text()) == sketched.SIDE
    values = Sketch.model_validate(sketched.FRONT), Sketch.model_validate(sketched.SIDE)
    again = [client.grow_sketches(*both, QUICK, seed=1) for both in (values, (sketched.FRONT, sketched.SIDE))]
    ends = [client.download(client.wait(one), tmp_path / one.id).read_bytes() for one in again]
    assert ends[0] == ends[1]


def test_sketches_are_traced(client: Client) -> None:
    told = client.trace_sketches(sketched.FRONT, sketched.SIDE, rev=4, grow=True)
    assert (told.rev, told.front.size) == (4, (200, 240))
    assert told.side is not None
    assert told.grown is not None
    assert told.score is not None
    with pytest.raises(ServiceError) as caught:
        client.trace_sketches({"branches": []})
    assert caught.value.errors[0].pointer == "/front/branches"


def test_a_photo_is_given_a_side_or_lends_its_colours(client: Client, photo: PhotoInfo) -> None:
    mixed = client.wait(client.grow(photo, STROKES, QUICK, side=sketched.SIDE), timeout=PATIENCE_SECONDS)
    assert {"strokes.json", "side.json"} <= set(mixed.files)
    over = client.wait(client.grow_sketches(sketched.FRONT, settings=QUICK, photo=photo), timeout=PATIENCE_SECONDS)
    assert (over.status, over.photo) == ("succeeded", photo.id)


def test_waiting_ends_in_time(client: Client, photo: PhotoInfo) -> None:
    model = client.grow(photo, STROKES, {"iterations": 2000, "leaf_density": 3}, seed=5)
    with pytest.raises(TimeoutError, match="not finished yet"):
        client.wait(model, timeout=0.3)
    client.cancel(model)


def test_a_service_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_connection, "_PAUSES_S", (0.01, 0.01))
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with Client(f"http://127.0.0.1:{port}") as client, pytest.raises(ServiceError, match="treestroke serve") as caught:
        client.model("mdl_1")
    assert (caught.value.status, caught.value.code) == (0, "unreachable")


def test_a_busy_service_is_asked_again(tree: ModelInfo) -> None:
    busy = json.dumps({"type": "", "title": "", "status": 503, "code": "overloaded", "detail": "busy"}).encode()
    model = tree.model_dump_json().encode()
    with saying((503, {"Retry-After": "1"}, busy), (200, {}, model)) as place, Client(place) as client:
        assert client.model(tree) == tree


def test_what_a_newer_service_adds_is_left_out(tree: ModelInfo) -> None:
    newer = json.dumps({**tree.model_dump(), "mood": "calm"}).encode()
    with saying((200, {}, newer)) as place, Client(place) as client:
        assert client.model(tree) == tree


@pytest.mark.parametrize("status", [200, 404])
def test_another_server_is_told_from_ours(status: int) -> None:
    html = (status, {}, b"<html>hello</html>")
    with saying(html) as place, Client(place) as client, pytest.raises(ServiceError) as caught:
        client.model("mdl_1")
    assert (caught.value.status, caught.value.code) == (status, "unknown_answer")


def test_a_damaged_file_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(client_connection, "_PAUSES_S", (0.01,))
    wrong = {"ETag": f'"{hashlib.sha256(b"right").hexdigest()}"'}
    with saying((200, wrong, b"wrong")) as place, Client(place) as client, pytest.raises(ServiceError, match="damaged"):
        client.download("mdl_1", tmp_path / "elm.glb")
    assert list(tmp_path.iterdir()) == []


def test_an_option_that_there_is_not_is_the_programmer_s_mistake(client: Client, photo: PhotoInfo) -> None:
    with pytest.raises(TypeError, match="colour"):
        client.grow(photo, STROKES, QUICK, colour="red")
    with pytest.raises(TypeError, match="bark"):
        client.grow_sketches(sketched.FRONT, None, QUICK, photo=photo, bark=b"")


def test_the_client_needs_none_of_the_modelling_packages() -> None:
    heavy = (
        "numpy",
        "cv2",
        "PIL",
        "maxflow",
        "sqlalchemy",
        "celery",
        "fastapi",
        "treestroke.core",
        "treestroke.service",
    )
    code = f"import sys, treestroke.client; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], env={"PYTHONPATH": str(BACKEND)}, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
