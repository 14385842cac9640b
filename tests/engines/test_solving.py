import numpy as np
import pytest
from tests.engines.rendered_set import centre_errors, photos_of, picture, ring

from treestroke.core.capture import CapturedPhoto
from treestroke.core.errors import CaptureError
from treestroke.engines.child import Bounds
from treestroke.engines.solving import SolveEnded, solve_in_process
from treestroke.engines.structure import solve

BOUNDS = Bounds(seconds=300.0, memory=3 * 2**30)
CAMERAS = ring(5, 60.0)


def test_photos_of_two_sizes_are_solved_in_another_process_as_in_this() -> None:
    photos = photos_of(CAMERAS)
    larger = CapturedPhoto(photos[1].name, picture(CAMERAS[1].resized(720, 540)))
    fractions: list[float] = []
    structure = solve_in_process([photos[0], larger, *photos[2:]], BOUNDS, lambda _, f: fractions.append(f))
    assert [photo.camera.width for photo in structure.photos] == [360, 720, 360, 360, 360]
    assert structure.photos[1].camera.focal_px == pytest.approx(2 * structure.photos[0].camera.focal_px, rel=0.05)
    assert np.median(centre_errors(structure, {f"{n:02d}.jpg": one for n, one in enumerate(CAMERAS)})) < 0.01
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    again = solve([photos[0], larger, *photos[2:]])
    assert (again.cloud.points == structure.cloud.points).all()
    pairs = zip(again.photos, structure.photos, strict=True)
    assert all((one.camera.camera_from_world == other.camera.camera_from_world).all() for one, other in pairs)


def test_refusals_arrive_with_their_code() -> None:
    with pytest.raises(CaptureError) as refusal:
        solve_in_process(photos_of(CAMERAS)[:3], BOUNDS)
    assert refusal.value.code == "too_few_photos"


def test_a_solve_that_takes_too_long_is_ended() -> None:
    with pytest.raises(SolveEnded) as ended:
        solve_in_process(photos_of(CAMERAS), BOUNDS._replace(seconds=0.2))
    assert ended.value.why == "slow"


def test_what_the_report_raises_ends_the_process() -> None:
    def report(stage: str, fraction: float) -> None:
        raise KeyError(stage)

    with pytest.raises(KeyError, match="solve"):
        solve_in_process(photos_of(CAMERAS), BOUNDS, report)
