"""Clips over HTTP: uploaded whole and in pieces, shown, traced, made into trees, deleted."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from tests.api.conftest import Service
from tests.clips import STROKES, clip_bytes, film, swaying

OCTETS = {"Content-Type": "application/octet-stream"}
PARTIAL = {"Content-Type": "application/partial-upload"}


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return clip_bytes(tmp_path_factory.mktemp("clips"))


@pytest.fixture(scope="module")
def clip(service: Service, video: bytes) -> dict[str, Any]:
    answer = service.client.post("/v1/clips", params={"name": "ash.avi"}, content=video, headers=OCTETS)
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def test_a_clip_is_described_by_its_frames(service: Service, clip: dict[str, Any]) -> None:
    assert (clip["name"], clip["width"], clip["height"]) == ("ash.avi", 160, 120)
    assert (clip["frames"], clip["frames_per_second"], clip["seconds"]) == (45, 30.0, 1.5)
    assert clip["notes"] == []
    assert service.client.get(f"/v1/clips/{clip['id']}").json() == clip
    assert clip["id"] in [one["id"] for one in service.client.get("/v1/clips").json()["clips"]]


def test_the_file_comes_back_whole_and_in_part(service: Service, clip: dict[str, Any], video: bytes) -> None:
    whole = service.client.get(clip["video"])
    assert whole.content == video
    assert whole.headers["content-type"] == "video/x-msvideo"
    part = service.client.get(clip["video"], headers={"Range": "bytes=100-199"})
    assert (part.status_code, part.content) == (206, video[100:200])


def test_a_form_brings_a_clip_with_its_name(service: Service, video: bytes) -> None:
    answer = service.client.post("/v1/clips", files={"file": ("oak.avi", video, "video/x-msvideo")})
    assert answer.status_code == 201, answer.text
    assert (answer.json()["name"], answer.json()["frames"]) == ("oak.avi", 45)
    assert service.rows("uploads") == 0


@pytest.mark.parametrize("frame", [0, 44, 7])
def test_frames_are_pictures(service: Service, clip: dict[str, Any], frame: int) -> None:
    answer = service.client.get(f"/v1/clips/{clip['id']}/frames/{frame}", params={"height": 60})
    assert answer.headers["content-type"] == "image/jpeg"
    picture = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
    wanted = cv2.resize(swaying()[frame], (80, 60), interpolation=cv2.INTER_AREA)
    assert picture.shape == (60, 80, 3)
    assert np.abs(picture.astype(float) - wanted).mean() < 6


def test_there_is_no_frame_beyond_the_last(service: Service, clip: dict[str, Any]) -> None:
    answer = service.client.get(f"/v1/clips/{clip['id']}/frames/45")
    assert (answer.status_code, answer.json()["code"]) == (404, "frame_not_found")


def test_a_trace_finds_foliage_branches_and_tracks(service: Service, clip: dict[str, Any]) -> None:
    answer = service.client.post(f"/v1/clips/{clip['id']}/trace", json={"frame": 5, **STROKES, "rev": 3, "grow": True})
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert (found["rev"], found["frame"]) == (3, 5)
    assert found["foliage"]
    assert len(found["skeleton"]["points"]) > 2
    assert found["grown"]["photo"]["width"] == 160
    tracks = found["tracks"]
    assert tracks["frames_per_second"] == 30.0
    assert all(len(track) == -(-45 // tracks["every"]) for track in tracks["points"])


def test_a_trace_names_a_frame_that_is_missing(service: Service, clip: dict[str, Any]) -> None:
    answer = service.client.post(f"/v1/clips/{clip['id']}/trace", json={"frame": 45, **STROKES})
    assert (answer.status_code, answer.json()["code"]) == (422, "frame_missing")
    assert answer.json()["errors"][0]["pointer"] == "/frame"


def test_a_clip_becomes_a_tree_that_keeps_its_own_copy(service: Service, video: bytes) -> None:
    clip = service.client.post("/v1/clips", content=video, headers=OCTETS).json()
    request = {"clip": clip["id"], "strokes": {"frame": 2, **STROKES}, "settings": {"iterations": 5}}
    model = service.make(**request)
    assert model["status"] == "succeeded", model["error"]
    assert model["clip"] == clip["id"]
    strokes = service.client.get(model["files"]["frame_strokes.json"]).json()
    assert strokes["frame"] == 2
    assert service.client.delete(f"/v1/clips/{clip['id']}").status_code == 204
    assert service.client.get(f"/v1/clips/{clip['id']}").json()["code"] == "clip_not_found"
    project = service.client.get(model["files"]["project"]).content
    assert video in project


@pytest.mark.parametrize(
    ("request_", "pointer", "code"),
    [
        ({"strokes": {"frame": 2, **STROKES}, "photo": "pho_0"}, "/clip", "missing_key"),
        ({"clip": "clp_0", "photo": "pho_0", "strokes": STROKES}, "/photo", "strokes_and_sketch"),
        ({"clip": "clp_0"}, "/strokes", "missing_key"),
        ({"clip": 7, "strokes": STROKES}, "/clip", "wrong_type"),
        ({"clip": "clp_0", "strokes": {"frame": -1, **STROKES}}, "/strokes/frame", "frame_missing"),
    ],
)
def test_a_request_for_a_tree_of_a_clip_is_checked(
    service: Service, request_: dict[str, Any], pointer: str, code: str
) -> None:
    answer = service.client.post("/v1/models", json=request_)
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert (fault["pointer"], fault["code"]) == (pointer, code)


def test_a_model_of_no_clip_is_not_found(service: Service) -> None:
    answer = service.client.post("/v1/models", json={"clip": f"clp_{0:024d}", "strokes": STROKES})
    assert (answer.status_code, answer.json()["code"]) == (404, "clip_not_found")


@pytest.mark.parametrize(
    ("content", "code"),
    [(b"", "clip_format"), (b"no video", "clip_format"), (b"\x89PNG\r\n\x1a\n" + bytes(99), "clip_format")],
)
def test_what_is_no_video_is_refused_and_not_kept(service: Service, content: bytes, code: str) -> None:
    answer = service.client.post("/v1/clips", content=content, headers=OCTETS)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert not list((service.data / "uploads").glob("*"))


def test_another_media_type_is_refused(service: Service) -> None:
    answer = service.client.post("/v1/clips", content=b"{}", headers={"Content-Type": "application/json"})
    assert answer.status_code == 415


class Sender:
    """A client that sends a clip in pieces."""

    def __init__(self, client: httpx.Client, video: bytes) -> None:
        self.client, self.video = client, video
        first = client.post("/v1/clips", params={"name": "elm.avi"}, headers={"Upload-Complete": "?0", **OCTETS})
        assert first.status_code == 201
        self.place = first.headers["Location"]

    def send(self, start: int, stop: int, offset: int | None = None, last: bool = False) -> httpx.Response:
        headers = {"Upload-Offset": str(start if offset is None else offset), "Upload-Complete": f"?{int(last)}"}
        return self.client.patch(self.place, content=self.video[start:stop], headers={**headers, **PARTIAL})

    def offset(self) -> int:
        return int(self.client.head(self.place).headers["Upload-Offset"])


@pytest.fixture
def sender(service: Service, video: bytes) -> Sender:
    return Sender(service.client, video)


def test_a_clip_arrives_in_pieces(sender: Sender) -> None:
    assert sender.send(0, 1000).headers["Upload-Complete"] == "?0"
    assert sender.send(1000, 5000).json()["offset"] == 5000
    assert sender.offset() == 5000
    answer = sender.send(5000, len(sender.video), last=True)
    assert answer.status_code == 201
    assert (answer.json()["name"], answer.json()["bytes"]) == ("elm.avi", len(sender.video))
    assert answer.headers["Location"] == f"/v1/clips/{answer.json()['id']}"
    assert sender.client.head(sender.place).headers["Upload-Complete"] == "?1"
    again = sender.send(len(sender.video), len(sender.video), last=True)
    assert again.json() == answer.json()


def test_a_piece_that_does_not_follow_is_refused_with_the_offset(sender: Sender) -> None:
    sender.send(0, 1000)
    answer = sender.send(900, 2000)
    assert (answer.status_code, answer.json()["code"]) == (409, "upload_offset_wrong")
    assert answer.headers["Upload-Offset"] == "1000"
    assert sender.offset() == 1000


def test_what_arrived_before_the_connection_broke_stays(sender: Sender, service: Service) -> None:
    arrived = service.data / "uploads" / sender.place.rpartition("/")[2]

    def broken() -> Iterator[bytes]:
        yield sender.video[:3000]
        while not arrived.exists() or arrived.stat().st_size < 3000:
            time.sleep(0.02)
        raise ConnectionError

    headers = {"Upload-Offset": "0", "Upload-Complete": "?1", **PARTIAL}
    with pytest.raises(ConnectionError):
        sender.client.patch(sender.place, content=broken(), headers=headers)
    offset = sender.offset()
    assert offset == 3000
    assert sender.send(offset, len(sender.video), last=True).status_code == 201


def test_an_upload_can_be_given_up(sender: Sender, service: Service) -> None:
    sender.send(0, 1000)
    assert sender.client.delete(sender.place).status_code == 204
    assert sender.client.head(sender.place).status_code == 404
    assert not (service.data / "uploads" / sender.place.rpartition("/")[2]).exists()


def test_an_upload_that_is_no_tree_that_moves_is_removed(service: Service, tmp_path: Path) -> None:
    still = film(tmp_path / "still.avi", swaying(1) * 40).read_bytes()
    sender = Sender(service.client, still)
    answer = sender.send(0, len(still), last=True)
    assert (answer.status_code, answer.json()["code"]) == (422, "clip_still")
    assert "treestroke model" in answer.json()["detail"]
    assert sender.client.head(sender.place).status_code == 404


def test_a_clip_that_is_too_long_to_be_taken_is_refused_before_it_is_sent(service: Service) -> None:
    headers = {"Upload-Complete": "?0", "Upload-Length": str(301_000_000), **OCTETS}
    answer = service.client.post("/v1/clips", headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "clip_too_large")
