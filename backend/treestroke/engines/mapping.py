"""Cameras and points from matched photos by COLMAP.

COLMAP: Schoenberger and Frahm 2016, "Structure-from-Motion Revisited".

Portraits are turned to landscape here, so that photos of one camera share one model of it, however it was held.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pycolmap

from treestroke.core.capture import CapturedPhoto
from treestroke.core.types import Floats, Indices
from treestroke.engines.features import Features

Pair = tuple[int, int]
"""Indices of two photos, ascending."""

pycolmap.logging.minloglevel = 2  # errors only: it tells of each step
for _level in (pycolmap.logging.INFO, pycolmap.logging.WARNING, pycolmap.logging.ERROR):
    pycolmap.logging.set_log_destination(_level, "")  # no file of its own

SEED = 1
"""Seed of all that COLMAP draws by chance."""
_LEAST_INLIERS = 20
"""Matches that two photos of one place must have in common."""
_LEAST_INLIER_SHARE = 0.25
_LIKELY_FOCAL = 1.2
"""Focal length over the longest side where none is known; COLMAP's."""
_PIXELS_PER_RADIAN_RANGE = 0.2, 8.0
"""Focal lengths over the longest side that a lens may have."""
_UNTURNED = np.eye(3)
_TURNED = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Turned camera from upright camera: a quarter to the left."""


@dataclass(frozen=True, eq=False)
class View:
    """A photo as COLMAP sees it.

    Attributes
    ----------
    name
        Its file name.
    size
        (width, height), px, landscape.
    focal_px
        Focal length, px; None if unknown.
    points_px
        (n, 2) its features, px.
    turn
        (3, 3) rotation to the camera of this view from the camera of the upright photo.
    """

    name: str
    size: tuple[float, float]
    focal_px: float | None
    points_px: Floats
    turn: Floats


class Matched(NamedTuple):
    """Photos with their features and matches; all lists are in the order of ``photos``."""

    photos: Sequence[CapturedPhoto]
    features: Sequence[Features]
    views: "Sequence[View]"
    cameras: Sequence[pycolmap.Camera]
    pairs: Mapping[Pair, pycolmap.TwoViewGeometry]

    @property
    def names(self) -> list[str]:
        """The photos' file names."""
        return [photo.name for photo in self.photos]


def view_of(photo: CapturedPhoto, features: Features) -> View:
    """Return a photo as COLMAP sees it."""
    height, width = photo.picture.shape[:2]
    if width >= height:
        return View(photo.name, (width, height), photo.focal_px, features.points_px, _UNTURNED)
    turned = np.column_stack([features.points_px[:, 1], width - features.points_px[:, 0]])
    return View(photo.name, (height, width), photo.focal_px, turned, _TURNED)


def cameras_of(views: Sequence[View]) -> list[pycolmap.Camera]:
    """Return the camera of each view; views of one size and focal length have the same one, told by its id."""
    keys = [(round(view.size[1]), None if view.focal_px is None else round(view.focal_px, 1)) for view in views]
    ids = {key: 1 + index for index, key in enumerate(dict.fromkeys(keys))}
    return [_camera(view, ids[key]) for view, key in zip(views, keys, strict=True)]


def _camera(view: View, number: int) -> pycolmap.Camera:
    width, height = view.size
    focal = view.focal_px or _LIKELY_FOCAL * max(view.size)
    camera = pycolmap.Camera(
        camera_id=number,
        model="SIMPLE_RADIAL",
        width=int(np.ceil(width)),
        height=int(np.ceil(height)),
        params=[focal, width / 2, height / 2, 0.0],
    )
    camera.has_prior_focal_length = view.focal_px is not None
    return camera


def verified(
    views: Sequence[View], cameras: Sequence[pycolmap.Camera], pair: Pair, matches: Indices
) -> pycolmap.TwoViewGeometry | None:
    """Return the relative pose that the matches (m, 2) of two views agree on; None if too few agree."""
    if len(matches) < _LEAST_INLIERS:
        return None
    first, second = pair
    options = pycolmap.TwoViewGeometryOptions()
    options.detect_watermark = False
    options.ransac.random_seed = SEED
    options.ransac.max_num_trials = 3000
    geometry = pycolmap.estimate_two_view_geometry(
        cameras[first],
        views[first].points_px,
        cameras[second],
        views[second].points_px,
        matches.astype(np.uint32),
        options,
    )
    inliers = len(geometry.inlier_matches)
    return geometry if inliers >= max(_LEAST_INLIERS, _LEAST_INLIER_SHARE * len(matches)) else None


def shows_no_parallax(geometry: pycolmap.TwoViewGeometry) -> bool:
    """Tell whether two photos look as if taken from one place, or show nothing but a plane."""
    kinds = pycolmap.TwoViewGeometryConfiguration
    flat = (kinds.PLANAR, kinds.PANORAMIC, kinds.PLANAR_OR_PANORAMIC)
    return geometry.config in [int(kind) for kind in flat]


def cache_of(
    views: Sequence[View], cameras: Sequence[pycolmap.Camera], pairs: Mapping[Pair, pycolmap.TwoViewGeometry]
) -> pycolmap.DatabaseCache:
    """Return COLMAP's store of views and their matches; the image of a view has its index plus 1 as its id."""
    database = pycolmap.Database.open(":memory:")
    try:
        for camera in {camera.camera_id: camera for camera in cameras}.values():
            database.write_camera(camera, use_camera_id=True)
            rig = pycolmap.Rig(rig_id=camera.camera_id)
            rig.add_ref_sensor(camera.sensor_id)
            database.write_rig(rig, use_rig_id=True)
        for number, (view, camera) in enumerate(zip(views, cameras, strict=True), start=1):
            image = pycolmap.Image(name=f"{number:04d}", camera_id=camera.camera_id, image_id=number)
            database.write_image(image, use_image_id=True)
            frame = pycolmap.Frame(frame_id=number, rig_id=camera.camera_id)
            frame.add_data_id(image.data_id)
            database.write_frame(frame, use_frame_id=True)
            database.write_keypoints(number, view.points_px.astype(np.float32))
        for (first, second), geometry in sorted(pairs.items()):
            database.write_matches(first + 1, second + 1, geometry.inlier_matches)
            database.write_two_view_geometry(first + 1, second + 1, geometry)
        return pycolmap.DatabaseCache.create(database, pycolmap.DatabaseCacheOptions())
    finally:
        database.close()


def reconstruct(
    cache: pycolmap.DatabaseCache, registered: Callable[[], None], few_matches: bool = False
) -> list[pycolmap.Reconstruction]:
    """Find cameras and points, by incremental structure from motion; the largest model first.

    ``registered()`` is called whenever a view has been added. With ``few_matches``, half of COLMAP's usual number of
    points in common is enough: for thin plants before a plain ground.
    """
    options = pycolmap.IncrementalPipelineOptions()
    options.num_threads = 1  # sums in a fixed order: the same photos give the same cameras
    options.random_seed = SEED
    options.extract_colors = False
    options.min_model_size = 3
    options.max_num_models = 4
    options.init_num_trials = 30
    options.min_focal_length_ratio, options.max_focal_length_ratio = _PIXELS_PER_RADIAN_RANGE
    if few_matches:
        options.mapper.init_min_num_inliers //= 2
        options.mapper.abs_pose_min_num_inliers //= 2
    models = pycolmap.ReconstructionManager()
    pipeline = pycolmap.IncrementalPipeline(options, cache, models)
    called = pycolmap.IncrementalPipelineCallback.NEXT_IMAGE_REG_CALLBACK
    pipeline.add_callback(int(called), registered)
    pipeline.run()
    found = [models.get(index) for index in range(models.size())]
    return sorted(found, key=lambda model: -model.num_reg_images())


def indices_of(model: pycolmap.Reconstruction) -> list[int]:
    """Return the indices of the views whose cameras a model has, ascending."""
    return sorted(number - 1 for number in model.reg_image_ids())
