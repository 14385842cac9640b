import numpy as np
import pytest
from tests.core.pipeline.walked_capture import structure_of
from tests.core.segment.walked_tree import walk

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.errors import CaptureError
from treestroke.core.pipeline.captured_photos import captured_photo, fitted, reduced

SHOTS, _ = walk(8)
NAMES = [shot.name for shot in SHOTS]


def test_a_photo_is_reduced_once_or_twice_and_knows_its_own_size() -> None:
    photo = captured_photo("a.jpg", np.zeros((3000, 4000, 3), np.uint8), 3200.0)
    assert (photo.picture.shape, photo.size_px, photo.focal_px) == ((960, 1280, 3), (4000, 3000), 1024.0)
    small = reduced(photo, 640)
    assert (small.picture.shape, small.size_px, small.focal_px) == ((480, 640, 3), (4000, 3000), 512.0)
    assert small.reduction == pytest.approx(0.16)
    assert reduced(small, 640) is small


def photo_of(name: str, width: int, height: int, side: int = 1280) -> CapturedPhoto:
    return reduced(CapturedPhoto(name, np.zeros((height, width, 3), np.uint8)), side)


def test_cameras_are_fitted_to_smaller_photos() -> None:
    structure = structure_of(SHOTS)
    smaller = fitted(structure, [photo_of(name, 800, 600, 100) for name in NAMES])
    before, after = structure.photos[3].camera, smaller.photos[3].camera
    assert (after.width, after.height) == (100, 75)
    points = structure.cloud.points[:5]
    assert np.allclose(after.pixels_from_world(points), before.pixels_from_world(points) / 2)
    assert fitted(structure, [photo_of(name, 200, 150) for name in NAMES]).photos == structure.photos


@pytest.mark.parametrize(
    ("photos", "fault"),
    [
        ([photo_of(name, 200, 150) for name in NAMES[1:]], "it names 0.jpg, which is not among the photos; put back"),
        ([photo_of(name, 150, 200) for name in NAMES], "its 0.jpg has another shape than the photo"),
    ],
)
def test_cameras_of_other_photos_are_refused(photos: list[CapturedPhoto], fault: str) -> None:
    with pytest.raises(CaptureError, match=f"^structure: {fault}") as refused:
        fitted(structure_of(SHOTS), photos)
    assert refused.value.code == "structure_of_other_photos"


def test_cameras_of_no_photo_are_refused() -> None:
    found = structure_of(SHOTS)
    with pytest.raises(CaptureError, match="it has no photo"):
        fitted(Structure((), found.cloud, found.unused), [photo_of(NAMES[0], 200, 150)])
