from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from tests.engines.rendered_set import camera_at, centre_errors, photos_of, ring, similarity

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.errors import CaptureError
from treestroke.engines.structure import solve

CAMERAS = ring(7, 82.0)
for number in (3, 5):  # held upright
    wide = CAMERAS[number]
    CAMERAS[number] = replace(wide, width=wide.height, height=wide.width, principal_px=wide.principal_px[::-1])
TRUE = {f"{n:02d}.jpg": camera for n, camera in enumerate(CAMERAS)}


@cache
def walk() -> tuple[CapturedPhoto, ...]:
    return tuple(photos_of(CAMERAS))


@cache
def solved() -> Structure:
    """Solve a walk with a copy, a blurred photo, one of another place and four of a further one among its photos."""
    photos = list(walk())
    blurred = replace(photos[2], name="shaken.jpg", picture=cv2.GaussianBlur(photos[2].picture, (0, 0), 3.0))
    stray = photos_of([CAMERAS[4]], seed=7, prefix="holiday")[0]
    other = photos_of(CAMERAS[:4], seed=9, prefix="other")
    return solve([*photos[:4], replace(photos[1], name="copy.jpg"), *photos[4:], blurred, stray, *other])


def test_cameras_are_where_the_photos_were_taken() -> None:
    assert [photo.name for photo in solved().photos] == sorted(TRUE)
    assert np.median(centre_errors(solved(), TRUE)) < 0.005


def test_up_is_up() -> None:
    found = np.array([photo.camera.centre for photo in solved().photos])
    turn = similarity(found, np.array([camera.centre for camera in CAMERAS]))[1]
    assert turn[1, 1] > np.cos(np.radians(2.0))


def test_points_project_to_where_photos_see_them() -> None:
    cloud = solved().cloud
    for number, photo in enumerate(solved().photos):
        seen = cloud.points[cloud.seen[:, number]]
        assert len(seen) > 100
        x, y = photo.camera.pixels_from_world(seen).T
        assert ((x > 0) & (x < photo.camera.width) & (y > 0) & (y < photo.camera.height)).all()


def test_photos_left_out_are_named_with_the_reason() -> None:
    reasons = {one.name: one.code for one in solved().unused}
    alone = {"copy.jpg": "same_photo", "shaken.jpg": "blurred", "holiday00.jpg": "no_overlap"}
    assert reasons == {**alone, **{f"other{n:02d}.jpg": "other_group" for n in range(4)}}
    assert all(one.name in one.detail for one in solved().unused)
    assert "01.jpg" in next(one.detail for one in solved().unused if one.name == "copy.jpg")


def test_photos_of_another_tree_are_named_together() -> None:
    detail = next(one.detail for one in solved().unused if one.name == "other00.jpg")
    assert "other01.jpg, other02.jpg and other03.jpg" in detail


def test_photos_held_either_way_share_a_lens() -> None:
    assert len({photo.camera.focal_px for photo in solved().photos}) == 1
    assert solved().photos[3].camera.height > solved().photos[3].camera.width


def test_fewer_than_five_photos_are_refused() -> None:
    with pytest.raises(CaptureError, match="00.jpg, 01.jpg, 02.jpg and 03.jpg") as refusal:
        solve(walk()[:4])
    assert refusal.value.code == "too_few_photos"


def test_copies_do_not_count() -> None:
    with pytest.raises(CaptureError, match="copy.jpg was taken from the same place as 00.jpg"):
        solve([*walk()[:4], replace(walk()[0], name="copy.jpg")])


def test_turning_on_the_spot_shows_no_parallax() -> None:
    eye = np.array([0.0, 2.0, 8.0])
    targets = [np.array([x, 0.9, 0.0]) for x in np.linspace(-1.2, 1.2, 5)]
    with pytest.raises(CaptureError, match="only turned") as refusal:
        solve(photos_of([camera_at(eye, target) for target in targets]))
    assert refusal.value.code == "no_parallax"


def test_photos_of_different_places_have_too_little_overlap() -> None:
    photos = [photos_of([camera], seed=20 + n, prefix=f"place{n}-")[0] for n, camera in enumerate(CAMERAS[:5])]
    with pytest.raises(CaptureError, match="place0-00.jpg") as refusal:
        solve(photos)
    assert refusal.value.code == "too_little_overlap"


def test_what_the_report_raises_ends_the_work() -> None:
    class Stopped(Exception):
        pass

    def report(stage: str, fraction: float) -> None:
        raise Stopped

    with pytest.raises(Stopped):
        solve(walk(), report)


def test_more_photos_than_are_read_are_refused_at_once() -> None:
    (photo, *_) = walk()
    with pytest.raises(CaptureError, match="there are 61 photos, at most 60 are read") as refusal:
        solve([replace(photo, name=f"{number}.jpg") for number in range(61)])
    assert refusal.value.code == "too_many_photos"
