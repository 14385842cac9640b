"""A drawn bare crown, of which just the stem is known: all its wood is traced, as thick as it is."""

import cv2
import numpy as np
import pytest
from tests.pictures import wood_mask

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace import bare_crown, fine_twigs
from treestroke.core.trace.bare_crown import find_twigs
from treestroke.core.trace.skeleton_builder import SkeletonBuilder

STEM = [(200.0, 390.0), (200.0, 220.0)]
LEFT, RIGHT = [(200.0, 220.0), (110.0, 60.0)], [(200.0, 220.0), (290.0, 60.0)]
TWIG = [(155.0, 140.0), (60.0, 150.0)]
LINES = [(LEFT, 9.0), (RIGHT, 7.0), (TWIG, 2.0)]
CROWN = np.arange(400)[:, None] + np.zeros((400, 400)) < 220
FINER = 4


def share_of(lines: list[tuple[list[tuple[float, float]], float]]) -> np.ndarray:
    """Share (400, 400) of each pixel that lines of such widths, px, cover."""
    fine = wood_mask([([(x * FINER, y * FINER) for x, y in line], width * FINER) for line, width in lines], 1600, 1600)
    return np.asarray(cv2.resize(fine.astype(np.float32), (400, 400), interpolation=cv2.INTER_AREA))


def traced(share: np.ndarray) -> SkeletonBuilder:
    """Follow the stem and look for twigs."""
    builder = SkeletonBuilder()
    builder.add_chain(-1, resample(np.array(STEM), 4.0), 8.0, stroke=0)
    find_twigs(builder, share * CROWN, CROWN, 380.0)
    return builder


def covered(builder: SkeletonBuilder) -> np.ndarray:
    """Share (400, 400) of each pixel that found twigs cover."""
    drawn = np.zeros((400 * FINER, 400 * FINER), dtype=np.uint8)
    for joint, parent in enumerate(builder.parents):
        if builder.stroke[joint] < 0:
            ends = [tuple(np.round(builder.points[at] * FINER).astype(int).tolist()) for at in (parent, joint)]
            cv2.line(drawn, ends[0], ends[1], 1, max(1, round(2 * FINER * builder.radii[joint])))
    return np.asarray(cv2.resize(drawn.astype(np.float32), (400, 400), interpolation=cv2.INTER_AREA))


def overlap(first: np.ndarray, second: np.ndarray) -> float:
    """Intersection over union of what is covered by half."""
    one, other = first > 0.5, second > 0.5
    return float((one & other).sum() / (one | other).sum())


def test_what_is_traced_covers_what_is_seen() -> None:
    share = share_of(LINES) * CROWN
    assert overlap(covered(traced(share)), share) > 0.8


@pytest.mark.parametrize(("width", "within"), [(1.0, 0.3), (2.0, 0.4), (4.0, 0.6), (9.0, 1.0)])
def test_a_twig_is_as_thick_as_it_is(width: float, within: float) -> None:
    builder = traced(share_of([(LEFT, 9.0), (TWIG, width)]))
    along = [
        2 * radius
        for point, radius in zip(builder.points, builder.radii, strict=True)
        if 75 < point[0] < 125 and point[1] > 135
    ]
    assert float(np.median(along)) == pytest.approx(width, abs=within)


def test_no_twig_is_thicker_than_what_bears_it() -> None:
    builder = traced(share_of(LINES))
    pairs = [(builder.radii[j], builder.radii[p]) for j, p in enumerate(builder.parents) if p >= 0]
    assert all(radius <= parent + 1e-9 for radius, parent in pairs)


def test_twigs_that_cross_make_no_loop() -> None:
    crossing = [*LINES, ([(90.0, 90.0), (230.0, 150.0)], 2.0)]
    builder = traced(share_of(crossing))
    assert all(parent < joint for joint, parent in enumerate(builder.parents))
    assert overlap(covered(builder), share_of(crossing) * CROWN) > 0.75


def test_a_thick_limb_goes_on_along_its_own_wood_where_a_thin_one_leads_to_it_by_a_shorter_way() -> None:
    thick, thin = [(200.0, 215.0), (80.0, 180.0), (170.0, 60.0)], [(200.0, 220.0), (150.0, 85.0)]
    builder = traced(share_of([(thick, 14.0), (thin, 2.0)]))
    beyond = [r for p, r in zip(builder.points, builder.radii, strict=True) if np.hypot(*(p - (125.0, 120.0))) < 20]
    assert max(beyond) > 5.0


def test_where_there_is_too_much_the_shortest_twigs_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    short = [([(110.0 + 0.56 * up, 60.0 + up), (100.0 + 0.56 * up, 57.0 + up)], 1.5) for up in range(20, 150, 26)]
    share = share_of([*LINES, *short])
    monkeypatch.setattr(fine_twigs, "MOST", 0)
    every = len(traced(share).points)
    monkeypatch.setattr(bare_crown, "MOST_JOINTS", int(0.6 * every))
    fewer = traced(share)
    assert len(fewer.points) < every
    assert overlap(covered(fewer), share_of(LINES[:2]) * CROWN) > 0.6


def test_a_crown_without_wood_has_no_twigs() -> None:
    assert min(traced(np.zeros((400, 400), dtype=np.float32)).stroke) == 0


def test_a_stroke_is_no_thicker_than_the_wood_around_it() -> None:
    builder = SkeletonBuilder()
    builder.add_chain(-1, resample(np.array([STEM[0], STEM[1], LEFT[1]]), 4.0), 12.0, stroke=0)
    find_twigs(builder, share_of(LINES) * CROWN, CROWN, 380.0)
    stroked = np.array(builder.stroke) == 0
    points, radii = np.array(builder.points)[stroked], np.array(builder.radii)[stroked]
    assert np.median(radii[points[:, 1] < 180]) == pytest.approx(4.5, abs=1.0)
    assert (radii[points[:, 1] > 300] == 12.0).all()
