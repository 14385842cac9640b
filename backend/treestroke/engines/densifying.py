"""More points for a solved model: matches along epipolar lines, triangulated; then all adjusted together once more."""

from collections.abc import Callable, Mapping
from itertools import combinations

import numpy as np
import pycolmap

from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats
from treestroke.engines.epipolar_matching import Rays, match_along_lines
from treestroke.engines.features import Features
from treestroke.engines.mapping import SEED, Matched, Pair, View, cache_of, indices_of

_NEIGHBOURS = 4
"""Photos with each of which a photo is matched once more."""
_WIDEST_RAD = np.radians(45.0)
"""Greatest parallax at which SIFT still matches well (Lowe 2004, section 6: up to 50 degrees)."""
_PARALLAX_MARGIN = 1.5
_ERROR_PX = 2.0
"""Greatest error of a point in a photo, px."""


def densify(model: pycolmap.Reconstruction, photos: Matched, advanced: Callable[[float], None]) -> None:
    """Add the points of further matches to a model, and adjust it; ``advanced(fraction)`` is told how far it is."""
    rays = {index: rays_of(model, photos.views[index], photos.features[index], index) for index in indices_of(model)}
    points = np.array([point.xyz for point in model.points3D.values()])
    ranges = _neighbours(rays, points)

    def match(pair: Pair) -> pycolmap.TwoViewGeometry:
        geometry = pycolmap.TwoViewGeometry()
        geometry.config = int(pycolmap.TwoViewGeometryConfiguration.CALIBRATED)
        matches = match_along_lines(rays[pair[0]], rays[pair[1]], ranges[pair])
        geometry.inlier_matches = matches.astype(np.uint32)
        return geometry

    matched = side_by_side(match, list(ranges), lambda part: advanced(0.7 * part))
    pairs = {**photos.pairs, **dict(zip(ranges, matched, strict=True))}
    _triangulate(model, cache_of(photos.views, photos.cameras, pairs))
    advanced(0.8)
    _adjust(model)


def rays_of(model: pycolmap.Reconstruction, view: View, features: Features, index: int) -> Rays:
    """Return what a view of a model, by its index, sees."""
    image = model.image(index + 1)
    camera = model.camera(image.camera_id)
    on_plane = np.asarray(camera.cam_from_img(view.points_px))
    ahead = np.column_stack([on_plane, np.ones(len(on_plane))])
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    turn = np.asarray(image.cam_from_world().rotation.matrix())
    return Rays(np.asarray(image.projection_center()), ahead @ turn, features.descriptors, 1 / camera.params[0])


def _neighbours(rays: Mapping[int, Rays], points: Floats) -> dict[Pair, tuple[float, float]]:
    """Return the pairs of photos that are near neighbours, and the range of the parallax of the points between them."""
    if not len(points):
        return {}
    toward = {index: _unit(one.centre - points) for index, one in rays.items()}
    ranges: dict[Pair, tuple[float, float]] = {}
    middle: dict[Pair, float] = {}
    for pair in combinations(sorted(rays), 2):
        parallax = np.arccos(np.clip((toward[pair[0]] * toward[pair[1]]).sum(axis=1), -1, 1))
        low, middle[pair], high = np.percentile(parallax, [1, 50, 99])
        ranges[pair] = float(low / _PARALLAX_MARGIN), float(min(high * _PARALLAX_MARGIN, np.pi / 2))
    chosen = set()
    for index in rays:
        near = sorted((middle[pair], pair) for pair in ranges if index in pair)
        chosen |= {pair for angle, pair in near[:_NEIGHBOURS] if angle < _WIDEST_RAD}
    return {pair: ranges[pair] for pair in sorted(chosen)}


def _triangulate(model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache) -> None:
    """Triangulate, with the cameras as they are, all matches that no point has yet."""
    options = pycolmap.IncrementalTriangulatorOptions()
    options.random_seed = SEED
    options.ignore_two_view_tracks = False
    options.create_max_angle_error = options.continue_max_angle_error = 0.2
    options.merge_max_reproj_error = options.complete_max_reproj_error = _ERROR_PX
    mapper = pycolmap.IncrementalMapper(cache)
    mapper.begin_reconstruction(model)
    for number in sorted(model.reg_image_ids()):
        mapper.triangulate_image(options, number)
    mapper.complete_and_merge_tracks(options)
    limits = pycolmap.IncrementalMapperOptions()
    limits.filter_max_reproj_error = _ERROR_PX
    mapper.filter_points(limits)
    mapper.end_reconstruction(False)


def _adjust(model: pycolmap.Reconstruction) -> None:
    """Adjust cameras and points together."""
    options = pycolmap.BundleAdjustmentOptions()
    options.print_summary = False
    options.ceres.loss_function_type = pycolmap.LossFunctionType.SOFT_L1
    options.ceres.solver_options.num_threads = 1
    options.ceres.solver_options.max_num_iterations = 30
    options.ceres.solver_options.function_tolerance = 1e-6
    config = pycolmap.BundleAdjustmentConfig()
    for number in sorted(model.reg_image_ids()):
        config.add_image(number)
    config.fix_gauge(pycolmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    pycolmap.create_default_bundle_adjuster(options, config, model).solve()


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
