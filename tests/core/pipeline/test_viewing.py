"""A walk around a small tree: leafy balls on a post, with the cameras that took its photos."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.core.pipeline.walked_capture import HEIGHT, structure_of
from tests.core.segment.walked_tree import cover, strokes_on, walk

from treestroke.core.capture import CapturedPhoto, SolvedPhoto
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.pipeline.drawn_views import mend_views
from treestroke.core.pipeline.finishing import TreeModel, finish
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.viewing import ViewsEvidence, grow_views, read_views
from treestroke.core.strokes import CameraDistance, CaptureStrokes, Stroke, Strokes

SHOTS, _ = walk(8)
PHOTOS = tuple(CapturedPhoto(shot.name, shot.picture) for shot in SHOTS)
DRAWN = CaptureStrokes({shot.name: strokes_on(shot) for shot in (SHOTS[0], SHOTS[4])}, None)
STRUCTURE = structure_of(SHOTS)


@cache
def evidence() -> ViewsEvidence:
    """Read the walk with a blurred photo, and one that was taken far away beside another tree."""
    aside = Similarity(np.array([40.0, 0.0, 0.0]), np.eye(3), 1.0).camera(STRUCTURE.photos[0].camera)
    cloud = replace(STRUCTURE.cloud, seen=np.pad(STRUCTURE.cloud.seen, ((0, 0), (0, 1))))
    with_ash = replace(STRUCTURE, photos=(*STRUCTURE.photos, SolvedPhoto("ash.jpg", aside, 0.0)), cloud=cloud)
    further = tuple(replace(PHOTOS[0], name=name) for name in ("shaken.jpg", "ash.jpg"))
    return read_views((*PHOTOS, *further), with_ash, DRAWN, HEIGHT)


@cache
def grown() -> TreeModel:
    settings, rng = ModelSettings(iterations=5, height=HEIGHT), np.random.default_rng(0)
    return finish(grow_views(evidence(), settings, rng), settings, rng)


def test_cameras_come_back_in_metres_around_the_root() -> None:
    for shot, found in zip(SHOTS, evidence().shots, strict=True):
        assert np.linalg.norm(found.camera.centre - shot.camera.centre) < 0.3


def test_mattes_are_where_the_tree_is() -> None:
    for shot, matte in zip(SHOTS, evidence().mattes, strict=True):
        tree = np.logical_or(*cover(shot.camera))
        assert (matte.tree & tree).sum() / (matte.tree | tree).sum() > 0.7


def test_the_crown_is_as_wide_and_high_as_the_balls() -> None:
    low, high = evidence().crown.bounds
    assert high[1] == pytest.approx(HEIGHT, rel=0.08)
    assert high[0] == pytest.approx(1.5, abs=0.3)
    assert low[0] == pytest.approx(-1.3, abs=0.3)


def test_the_finished_tree_covers_what_the_photos_show() -> None:
    leaf = grown().leaf
    assert leaf is not None
    places = leaf.mesh.positions.astype(np.float64)
    for shot in evidence().shots:
        tree = np.logical_or(*cover(shot.camera))
        x, y = np.floor(shot.camera.pixels_from_world(places)).astype(int).T.clip([[0], [0]], [[199], [149]])
        assert tree[y, x].mean() > 0.7
    assert places[:, 1].max() == pytest.approx(HEIGHT, rel=0.1)


def test_the_tree_stands_on_its_root() -> None:
    skeleton = grown().grown.skeleton
    assert skeleton.points[0] == pytest.approx([0.0, 0.0, 0.0], abs=0.1)
    assert (skeleton.parents < 0).sum() == 1


def test_cameras_and_unused_photos_go_along() -> None:
    captured = grown().captured
    assert captured is not None
    assert captured.names == tuple(shot.name for shot in SHOTS)
    assert {(camera.width, camera.height) for camera in captured.cameras} == {(200, 150)}
    assert [(photo.name, photo.code) for photo in captured.unused] == [
        ("shaken.jpg", "blurred"),
        ("ash.jpg", "other_tree"),
    ]
    told = {(warning.code, warning.stroke) for warning in grown().warnings}
    assert told >= {("blurred", "photos/shaken.jpg"), ("other_tree", "photos/ash.jpg")}


def bad(name: str = SHOTS[0].name, trunk: bool = True, scale: CameraDistance | None = None) -> CaptureStrokes:
    strokes = DRAWN.by_photo[SHOTS[0].name]
    return CaptureStrokes({name: strokes if trunk else replace(strokes, branches=())}, scale)


OUTSIDE = Strokes(Stroke(np.array([[900.0, 10.0], [950.0, 10.0], [950.0, 60.0]])), (), ())


@pytest.mark.parametrize(
    ("drawn", "code", "pointer"),
    [
        (bad("gone.jpg"), "photo_unknown", "/views/0/photo"),
        (bad(trunk=False), "trunk_missing", "/views/0/branches"),
        (bad(scale=CameraDistance(("0.jpg", "gone.jpg"), 2.0)), "photo_unknown", "/scale/photos/1"),
        (bad(scale=CameraDistance(("0.jpg", "0.jpg"), 2.0)), "scale_invalid", "/scale/photos"),
        (CaptureStrokes({"0.jpg": OUTSIDE}, None), "stroke_too_short", "/views/0/crown"),
    ],
)
def test_strokes_that_do_not_fit_the_photos_are_refused(drawn: CaptureStrokes, code: str, pointer: str) -> None:
    with pytest.raises(StrokesError) as refused:
        mend_views(drawn, {photo.name: photo.size_px for photo in PHOTOS})
    assert (refused.value.code, refused.value.pointer) == (code, pointer)


def test_a_trunk_on_a_photo_without_a_camera_is_refused() -> None:
    photos = (*PHOTOS, replace(PHOTOS[0], name="shaken.jpg"))
    with pytest.raises(StrokesError, match=r"no camera was found for shaken\.jpg; .* such as 0\.jpg") as refused:
        read_views(photos, STRUCTURE, bad("shaken.jpg"), HEIGHT)
    assert refused.value.code == "photo_not_used"


def test_too_few_photos_of_the_tree_that_was_drawn_are_refused() -> None:
    aside = Similarity(np.array([40.0, 0.0, 0.0]), np.eye(3), 1.0)
    moved = [
        photo if place in (0, 4) else replace(photo, camera=aside.camera(photo.camera))
        for place, photo in enumerate(STRUCTURE.photos)
    ]
    with pytest.raises(StrokesError, match="fewer than 5 photos show the tree") as refused:
        read_views(PHOTOS, replace(STRUCTURE, photos=tuple(moved)), DRAWN, HEIGHT)
    assert refused.value.code == "no_tree"
