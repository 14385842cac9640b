"""A tree that no photo recipe made: an ellipsoid for a crown, seen by two perspective cameras."""

from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera, PerspectiveCamera
from treestroke.core.geometry.crown_volume import Silhouette, shown_by_all
from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.library import TYPE_1, TYPE_2
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.replacement import CrownToFill, Replacement, grow
from treestroke.core.grow.self_similar import SelfSimilarParams, grow_small
from treestroke.core.leaf.leaves import fruit_among
from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.finishing import TreeModel, finish
from treestroke.core.pipeline.grown_tree import GrownTree, Reading
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.taken import Taken
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.survey.measures import Scale, Stature
from treestroke.core.types import Floats, Mask

GREEN, RED, BARK, SKY = (60, 140, 40), (190, 50, 30), (150, 120, 90), (170, 200, 240)
SETTINGS = ModelSettings(height=8, leaf_density=0.5)


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """A crown volume by formula, of half axes along X, Y and Z, metres."""

    centre: Floats
    half: Floats
    depth_seen: bool = True
    shape: str = "that is an ellipsoid"

    @property
    def bounds(self) -> Floats:
        return np.stack([self.centre - self.half, self.centre + self.half])

    @property
    def widest(self) -> float:
        return float(self.half[0])

    @property
    def front_area(self) -> float:
        return float(np.pi * self.half[0] * self.half[1])

    @property
    def cubic_metres(self) -> float:
        return float(4 / 3 * np.pi * self.half.prod())

    def inside(self, points_world: Floats) -> Mask:
        return np.asarray((((points_world - self.centre) / self.half) ** 2).sum(axis=1) <= 1)

    def shown(self, points_world: Floats) -> Mask:
        return self.inside(points_world)

    def admits(self, points_world: Floats) -> Mask:
        return self.inside(points_world)

    def reach(self, points_world: Floats) -> Floats:
        way = (points_world - self.centre) / self.half
        return np.hypot(way[:, 0], way[:, 2]) / np.maximum(self._level(points_world[:, 1]), 1e-9)

    def axis(self, heights_m: Floats) -> Floats:
        low, high = self.bounds[:, 1]
        x, z = (np.full(len(heights_m), self.centre[axis]) for axis in (0, 2))
        return np.stack([x, np.clip(heights_m, low, high), z], axis=1)

    def half_width(self, heights_m: Floats) -> Floats:
        return self.half[0] * self._level(heights_m)

    def half_depth(self, points_world: Floats) -> Floats:
        x, y = ((points_world - self.centre) / self.half)[:, :2].T
        return self.half[2] * np.sqrt(np.maximum(1 - x**2 - y**2, 0))

    def _level(self, heights_m: Floats) -> Floats:
        """Size (n,) of the section at a height over the widest one."""
        return np.sqrt(np.maximum(1 - ((heights_m - self.centre[1]) / self.half[1]) ** 2, 0))


VOLUME = Ellipsoid(np.array([0.3, 5.0, -0.4]), np.array([2.0, 3.0, 1.4]))
FRONT = OrthographicCamera(500, 700, 0.0125, (250.0, 680.0))


def standing_at(place: Floats) -> PerspectiveCamera:
    """A level camera that looks at the crown from a place."""
    forward = unit((VOLUME.centre - place) * [1, 0, 1])
    turn = np.stack([np.cross(forward, [0.0, 1.0, 0.0]), [0.0, -1.0, 0.0], forward])
    return PerspectiveCamera(600, 800, np.column_stack([turn, -turn @ place]), 900.0, (300.0, 400.0))


CAMERAS = (standing_at(np.array([0.0, 4.0, 12.0])), standing_at(np.array([-11.0, 4.0, -2.0])))


def outline_of(camera: PerspectiveCamera | OrthographicCamera) -> Mask:
    """The volume's pixels: the hull of points on its surface."""
    way = unit(np.random.default_rng(0).normal(size=(20_000, 3)))
    points_px = camera.pixels_from_world(VOLUME.centre + VOLUME.half * way)
    hull = cv2.convexHull(np.round(points_px - 0.5).astype(np.int32))
    return cv2.fillConvexPoly(np.zeros((camera.height, camera.width), np.uint8), hull, 1) > 0


def trunk() -> Skeleton:
    """A trunk into the crown's middle with two limbs that leave it to both sides."""
    y = np.linspace(0, 5.5, 23)
    points = [np.array([0.3 * h / 5.5, h, -0.4 * h / 5.5]) for h in y]
    parents = list(range(-1, 22))
    for bud, way in ((13, [0.12, 0.1, 0.04]), (16, [-0.12, 0.1, -0.04])):
        for step in range(8):
            parents.append(bud if step == 0 else len(points) - 1)
            points.append(points[parents[-1]] + np.array(way))
    radii = np.concatenate([np.linspace(0.16, 0.07, 23), np.full(16, 0.05)])
    return Skeleton(np.array(points), radii, np.array(parents))


def view_of(camera: PerspectiveCamera, colour: tuple[int, int, int]) -> View:
    """A picture drawn by hand: sky, a crown of one colour, and the trunk below and before it."""
    crown, tree = outline_of(camera), trunk()
    picture = np.full((camera.height, camera.width, 3), SKY, np.uint8)
    noise = np.random.default_rng(1).normal(0, 9, (*crown.shape, 1))
    picture[crown] = colour
    stem = np.arange(23)
    stem_px = camera.pixels_from_world(tree.points[stem])
    radii_px = tree.radii[stem] / camera.pixel_size(tree.points[stem])
    depth, wood = camera.depth(tree.points[stem]), np.full(crown.shape, np.nan, np.float32)
    for k in range(1, 23):
        ends = [tuple(np.round(stem_px[at]).astype(int).tolist()) for at in (k - 1, k)]
        cv2.line(picture, *ends, BARK, round(2 * radii_px[k]))
        cv2.line(wood, *ends, float(depth[k]), round(2 * radii_px[k]))
    leaves_from = np.where(np.isnan(wood), np.where(crown, -np.inf, np.inf), wood).astype(np.float32)
    picture = np.clip(picture + noise, 0, 255).astype(np.uint8)
    foliage = np.isneginf(leaves_from)
    seen = (foliage.astype(np.float32), foliage, crown | ~np.isnan(wood))
    return View(camera, picture, leaves_from, *seen, StemPixels(stem_px, radii_px))


def dressed(grown: Grown) -> GrownTree:
    views = tuple(view_of(camera, colour) for camera, colour in zip(CAMERAS, (GREEN, RED), strict=True))
    return GrownTree(
        taken=Taken("leaves", "round", 1.0),
        grown=grown,
        volume=VOLUME,
        appearance=Appearance(views, shows_leaves=True),
        camera=FRONT,
        expected=(Silhouette(outline_of(FRONT), FRONT),),
        stature=Stature(8.0, Scale(0.0125, False, 0.0), True, VOLUME),
        score={},
        reading=Reading("a volume made by hand", ()),
        warnings=(),
    )


def fruit_picture() -> np.ndarray:
    picture = np.zeros((40, 40, 4), np.uint8)
    cv2.circle(picture, (20, 20), 19, (250, 200, 0, 255), -1)
    return picture


@pytest.fixture(scope="module")
def grown() -> Grown:
    crown = CrownToFill(VOLUME, Silhouette(outline_of(FRONT), FRONT))
    return grow(trunk(), crown, Replacement(TYPE_1 + TYPE_2, GrowthParams(120)), np.random.default_rng(0))


@pytest.fixture(scope="module")
def model(grown: Grown) -> TreeModel:
    return finish(dressed(grown), SETTINGS, np.random.default_rng(0), pictures=OwnPictures(fruit=fruit_picture()))


def silhouettes() -> list[Silhouette[PerspectiveCamera]]:
    return [Silhouette(cv2.dilate(outline_of(c).astype(np.uint8), np.ones((5, 5))) > 0, c) for c in CAMERAS]


def test_wood_fills_the_volume_and_stays_inside_it_and_both_pictures(grown: Grown) -> None:
    new = grown.skeleton.points[grown.born > 0]
    assert len(new) > 500
    assert VOLUME.reach(new).max() <= 1.05
    assert shown_by_all(silhouettes(), new).mean() > 0.99
    assert np.ptp(new, axis=0) == pytest.approx(2 * VOLUME.half, rel=0.25)


def test_small_copies_of_branches_fill_it_too() -> None:
    tree, branch = trunk(), np.repeat([0, 1, 2], [23, 8, 8])
    params = SelfSimilarParams(most=300)
    small = grow_small(Branched(tree, branch), VOLUME, params, np.random.default_rng(0))
    assert (small.born > 0).sum() > 300
    assert VOLUME.inside(small.skeleton.points[small.born > 0]).all()


def test_leaves_and_fruit_stay_inside_the_volume_and_both_pictures(model: TreeModel) -> None:
    cards, atlas = model.cards, model.atlas
    assert cards is not None
    assert atlas is not None
    full = cards.select(np.linalg.norm(cards.ups, axis=1) > 0.01)
    fruit = fruit_among(full, atlas)
    assert fruit.sum() >= 20
    assert (~fruit).sum() > 1000
    assert VOLUME.inside(full.centres).all()
    assert shown_by_all(silhouettes(), full.centres).all()


def test_leaves_cover_the_foliage_in_both_pictures(model: TreeModel) -> None:
    for camera in CAMERAS:
        crown = outline_of(camera)
        row = np.floor(camera.pixels_from_world(model.cards.centres)).astype(int)
        drawn = np.zeros(crown.shape, np.uint8)
        drawn[row[:, 1], row[:, 0]] = 1
        near = cv2.dilate(drawn, np.ones((25, 25))) > 0
        assert (near & crown).sum() > 0.9 * crown.sum()


def test_leaves_take_their_colour_from_the_picture_that_shows_them(model: TreeModel) -> None:
    cards, atlas = model.cards, model.atlas
    leaves = cards.select(~fruit_among(cards, atlas))
    red = atlas.colours[leaves.tiles][:, 0] > atlas.colours[leaves.tiles][:, 1]
    outward = leaves.centres - VOLUME.axis(leaves.centres[:, 1])
    before, beside = ((outward * camera.toward_viewer(leaves.centres)).sum(axis=1) for camera in CAMERAS)
    assert red[(beside > 0.5) & (before < 0.2)].mean() > 0.95
    assert red[(before > 0.5) & (beside < 0.2)].mean() < 0.05


def test_bark_has_the_colour_of_the_stems_pixels(model: TreeModel) -> None:
    texture = model.bark.texture.reshape(-1, 3).mean(axis=0)
    assert texture == pytest.approx(BARK, abs=25)


def test_its_measures_are_the_volumes(model: TreeModel) -> None:
    figures = model.measures.figures
    assert figures["crown_volume"].value == pytest.approx(VOLUME.cubic_metres)
    assert figures["crown_volume"].meaning == "of the solid that is an ellipsoid"
    assert figures["crown_depth"].basis == "measured"


def test_one_glb_is_written_from_it(model: TreeModel) -> None:
    parts = [Part("bark", model.bark), Part("leaf", model.leaf)]
    assert encode_glb(parts, model.camera, provenance=Provenance("treestroke"))[:4] == b"glTF"


def test_the_same_seed_gives_the_same_leaves(grown: Grown, model: TreeModel) -> None:
    again = finish(dressed(grown), SETTINGS, np.random.default_rng(0), pictures=OwnPictures(fruit=fruit_picture()))
    assert np.array_equal(again.cards.centres, model.cards.centres)
