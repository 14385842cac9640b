import numpy as np
import pytest
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask

from treestroke.core.geometry.camera import Camera

CAMERA = Camera(200, 200, 0.1, (100.0, 190.0))


def ball(radius: float = 60.0) -> np.ndarray:
    y, x = np.mgrid[:200, :200] + 0.5
    return np.hypot(x - 100, y - 100) < radius


@pytest.fixture
def sphere() -> Envelope:
    return envelope_of_mask(ball(), CAMERA)


def world(x_px: float, y_px: float, depth_m: float = 0.0) -> np.ndarray:
    return CAMERA.world_from_pixels(np.array([[x_px, y_px]]), depth_m)


def test_a_disc_turns_into_a_ball(sphere: Envelope) -> None:
    rows = np.arange(50, 151)
    assert sphere.radius_px[rows] == pytest.approx(np.sqrt(60**2 - (rows + 0.5 - 100) ** 2), abs=1.5)
    assert sphere.middle_px[rows] == pytest.approx(np.full(101, 100.0))


def test_reach_is_one_on_the_surface_and_grows_outward(sphere: Envelope) -> None:
    depths = [0.0, 3.0, 6.0, 9.0]
    assert [sphere.reach(world(100, 100, z))[0] for z in depths] == pytest.approx([0.0, 0.5, 1.0, 1.5], abs=0.02)


@pytest.mark.parametrize("x", [45.0, 70.0, 100.0, 140.0])
def test_half_depth_lies_on_the_surface(sphere: Envelope, x: float) -> None:
    depth = sphere.half_depth(world(x, 110.0))[0]
    assert sphere.reach(world(x, 110.0, depth))[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("x", "y"), [(30.0, 100.0), (101.0, 20.0), (101.0, 195.0), (500.0, 100.0), (101.0, -40.0)])
def test_there_is_no_depth_outside_the_crown(sphere: Envelope, x: float, y: float) -> None:
    assert sphere.half_depth(world(x, y))[0] == 0.0
    assert sphere.reach(world(x, y))[0] > 1.0


def test_rows_without_crown_have_no_section(sphere: Envelope) -> None:
    assert not sphere.radius_px[:40].any()
    assert not sphere.radius_px[160:].any()


def test_a_gap_between_two_crowns_is_bridged() -> None:
    mask = ball()
    mask[95:105] = False
    assert (envelope_of_mask(mask, CAMERA).radius_px[95:105] > 55).all()


def test_one_stray_twig_gives_no_disc() -> None:
    mask = ball()
    mask[100, 100:195] = True
    with_twig, without = envelope_of_mask(mask, CAMERA), envelope_of_mask(ball(), CAMERA)
    assert with_twig.radius_px[100] - without.radius_px[100] < 0.25 * 35 / 2


@pytest.mark.parametrize("mask", [np.zeros((200, 200), dtype=bool), np.ones((200, 100), dtype=bool)])
def test_a_mask_that_is_no_crown_of_the_photo_is_refused(mask: np.ndarray) -> None:
    with pytest.raises(ValueError, match="crown|fit"):
        envelope_of_mask(mask, CAMERA)


@pytest.fixture
def flattened(sphere: Envelope) -> Envelope:
    """The ball, a third as deep as wide, two metres nearer to the viewer than the root."""
    y, x = np.mgrid[:200, :200] + 0.5
    side = np.hypot((x - 120) * 3, y - 100) < 60
    return sphere.with_side(side, CAMERA)


def test_a_side_gives_sections_their_own_depth_and_middle(flattened: Envelope) -> None:
    points = np.vstack([world(100, 100, z) for z in (0.0, 2.0, 4.0)])
    assert flattened.reach(points) == pytest.approx([1.0, 0.0, 1.0], abs=0.05)
    assert flattened.half_depth(points) == pytest.approx(np.full(3, 2.0), abs=0.1)
    assert flattened.widened(2.0).reach(points) == pytest.approx([0.5, 0.0, 0.5], abs=0.05)


def test_a_side_at_another_scale_gives_the_same_depth(sphere: Envelope, flattened: Envelope) -> None:
    y, x = np.mgrid[:400, :400] + 0.5
    side = np.hypot((x - 240) * 3, y - 200) < 120
    finer = sphere.with_side(side, Camera(400, 400, 0.05, (200.0, 380.0)))
    points = np.vstack([world(x, y, 1.0) for x in (70.0, 110.0) for y in (60.0, 100.0, 140.0)])
    assert finer.reach(points) == pytest.approx(flattened.reach(points), abs=0.03)


def test_rounding_makes_the_sections_circles_and_can_be_taken_back(sphere: Envelope, flattened: Envelope) -> None:
    points = np.vstack([world(x, y, z) for x in (70.0, 110.0) for y in (70.0, 120.0, 180.0) for z in (0.5, 2.5)])
    inside = points[:, 1] > 3.1
    rounded = flattened.rounded(points)
    assert sphere.reach(rounded[inside]) == pytest.approx(flattened.reach(points[inside]))
    assert flattened.unrounded(rounded) == pytest.approx(points)
    assert sphere.rounded(points) == pytest.approx(points)


def test_middles_of_the_sections_are_where_both_sides_show_them(sphere: Envelope, flattened: Envelope) -> None:
    points = world(30, 100, 7.0)
    assert flattened.middles(points) == pytest.approx(world(100, 100, 2.0), abs=0.1)
    assert sphere.middles(points) == pytest.approx(world(100, 100, 0.0), abs=0.1)


def test_what_the_side_shows_is_told_at_any_place_across(sphere: Envelope, flattened: Envelope) -> None:
    points = np.vstack([world(x, 100, z) for x in (100, 155) for z in (-0.5, 0.5, 3.5, 4.5)])
    assert flattened.shown_from_side(points).tolist() == 2 * [False, True, True, False]
    assert sphere.shown_from_side(points).all()
