from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.pictures import disc, leaves_on_sky, noisy, overlap, ring

from treestroke.codec.image import decode_photo
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.segment.foliage import FoliageParams, segment_foliage
from treestroke.service.loading import load_strokes

SIZE, MIDDLE = 300, (150.0, 150.0)
CROWN = ring(115, MIDDLE)
COLOURS = {"green": (70, 120, 40), "red": (190, 60, 40), "yellow": (220, 190, 60), "white": (240, 235, 230)}


@pytest.mark.parametrize("leaf", COLOURS.values(), ids=COLOURS)
def test_a_disc_of_leaves_is_found_inside_a_loose_stroke(leaf: tuple[int, int, int]) -> None:
    truth = disc(SIZE, 100)
    assert overlap(segment_foliage(leaves_on_sky(truth, leaf), CROWN).mask, truth) > 0.95


@pytest.mark.parametrize("leaf", COLOURS.values(), ids=COLOURS)
def test_a_gap_in_the_crown_stays_open(leaf: tuple[int, int, int]) -> None:
    gap = disc(SIZE, 22, (185.0, 120.0))
    found = segment_foliage(leaves_on_sky(disc(SIZE, 100) & ~gap, leaf), CROWN).mask
    assert found[gap].mean() < 0.1
    assert overlap(found, disc(SIZE, 100) & ~gap) > 0.95


def test_a_stroke_a_little_inside_the_leaves_is_forgiven() -> None:
    truth = disc(SIZE, 100)
    found = segment_foliage(leaves_on_sky(truth, COLOURS["green"]), ring(99, MIDDLE))
    assert (found.region & ~fill_outline(ring(99, MIDDLE), SIZE, SIZE)).any()
    assert overlap(found.mask, truth) > 0.9


def test_foliage_lies_in_its_region_near_the_crown() -> None:
    photo = leaves_on_sky(np.ones((SIZE, SIZE), dtype=bool), COLOURS["green"])
    found = segment_foliage(photo, CROWN, FoliageParams(dilation_px=25))
    assert not (found.mask & ~found.region).any()
    assert np.array_equal(found.region, disc(SIZE, 120)) or overlap(found.region, disc(SIZE, 120)) > 0.98


@pytest.mark.parametrize("colour", [(0, 0, 0), (120, 165, 225), (255, 255, 255)])
def test_a_plain_picture_still_gives_some_foliage(colour: tuple[int, int, int]) -> None:
    flat = np.full((SIZE, SIZE, 3), colour, np.uint8)
    for photo in (flat, noisy(flat)):
        assert segment_foliage(photo, CROWN).mask.any()


def test_a_crown_as_large_as_the_picture_has_no_ring_and_is_found() -> None:
    frame = np.array([[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]], float)
    truth = disc(SIZE, 120)
    assert overlap(segment_foliage(leaves_on_sky(truth, COLOURS["green"]), frame).mask, truth) > 0.9


def test_the_same_photo_gives_the_same_mask() -> None:
    photo = leaves_on_sky(disc(SIZE, 100), COLOURS["red"])
    assert np.array_equal(segment_foliage(photo, CROWN).mask, segment_foliage(photo, CROWN).mask)


@pytest.mark.parametrize(
    ("folder", "name", "least"),
    [(EXAMPLES, "sugar_maple_autumn", 0.93), (EXAMPLES, "burr_oak_dusk", 0.80), (DATA, "cherry_blossom", 0.80)],
)
def test_a_real_crown_agrees_with_its_mask(folder: Path, name: str, least: float) -> None:
    photo = decode_photo((folder / f"{name}.jpg").read_bytes(), name)
    truth = cv2.imread(str(DATA / f"{name}.mask.png"), cv2.IMREAD_GRAYSCALE) > 127
    found = segment_foliage(photo, load_strokes(folder / f"{name}.strokes.json").crown.points)
    assert overlap(found.mask & found.region, truth & found.region) > least


@pytest.mark.parametrize(
    ("folder", "name"), [(DATA, "redbud_park"), (DATA, "boxelder_lawn"), (EXAMPLES, "osage_orange_autumn")]
)
def test_leaves_before_a_lawn_and_trees_of_their_colour_are_found(folder: Path, name: str) -> None:
    photo = decode_photo((folder / f"{name}.jpg").read_bytes(), name)
    crown_px = load_strokes(folder / f"{name}.strokes.json").crown.points
    inside = fill_outline(crown_px, *photo.shape[:2])
    rows = np.flatnonzero(inside.any(axis=1))
    inside[: (rows[0] + rows[-1]) // 2] = False
    assert segment_foliage(photo, crown_px).covered[inside].mean() > 0.66


@pytest.mark.parametrize(
    "changes", [{"components": 1}, {"samples": 99}, {"cut_pixels": 999}, {"dilation_px": -1.0}, {"smoothness": -1.0}]
)
def test_parameters_out_of_range_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="foliage needs|cannot be negative"):
        FoliageParams(**changes)
