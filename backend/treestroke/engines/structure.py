"""Structure from motion: where the photos of a tree were taken, and points that several of them see."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
import pycolmap
from threadpoolctl import threadpool_limits

from treestroke.core.capture import CapturedPhoto, PointCloud, SolvedPhoto, Structure, UnusedPhoto
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.progress import Report, silent
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Indices
from treestroke.engines.bad_photos import (
    blurred,
    check_count,
    no_parallax,
    repeated,
    too_little_overlap,
    without_camera,
)
from treestroke.engines.contradictions import contradicts, without_weak
from treestroke.engines.densifying import densify
from treestroke.engines.features import find_features
from treestroke.engines.lone_points import confirmed
from treestroke.engines.mapping import (
    Matched,
    Pair,
    View,
    cache_of,
    cameras_of,
    indices_of,
    reconstruct,
    shows_no_parallax,
    verified,
    view_of,
)
from treestroke.engines.matching import match_descriptors
from treestroke.engines.upright import unit_scale, up_direction, upright_turn
from treestroke.limits import MIN_PHOTOS

_STRONG = 1000
"""Features by which it is found out which photos are worth matching: the largest, which most others show again."""
_STRONG_RATIO = 0.85
_ALIKE, _NEXT = 6, 2
"""Photos most like a photo with which it is matched, and the next ones in the order of the walk."""
_LEAST_SPREAD = 0.03
"""Least distance between the farthest two cameras over their distance from the points; below, there is no parallax."""
_FLAT_SHARE = 0.7
"""Share of the pairs that look as if taken from one place from which on all photos were."""


def solve(photos: Sequence[CapturedPhoto], report: Report = silent) -> Structure:
    """Find where photos of one tree were taken, and points that several of them see, by structure from motion.

    Photos that do not help are left out, each with the reason. The same photos give the same structure. An exception
    that ``report("solve", fraction)`` raises ends the work.

    Raises
    ------
    CaptureError
        Fewer than 5 photos are usable (``too_few_photos``), all were taken from one place (``no_parallax``), or too few
        show the same things (``too_little_overlap``).
    """
    check_count([photo.name for photo in photos], ())
    with threadpool_limits(1):  # pictures and pairs run side by side instead
        matched, unused = _match(photos, lambda part: report("solve", 0.65 * part))
        model, others = _largest(matched, lambda part: report("solve", 0.65 + 0.15 * part))
        densify(model, matched, lambda part: report("solve", 0.8 + 0.19 * part))
        left_out = [*unused.values(), *_without_camera(matched, model, others)]
        structure = _structure(matched, model, [photo.name for photo in photos], left_out)
    report("solve", 1.0)
    return structure


def _match(
    photos: Sequence[CapturedPhoto], advanced: Callable[[float], None]
) -> tuple[Matched, dict[int, UnusedPhoto]]:
    """Find features and matches; photos that repeat another or are blurred are left out."""
    features = list(side_by_side(lambda photo: find_features(photo.picture), photos, lambda part: advanced(0.4 * part)))
    strong = [one.descriptors[np.argsort(-one.sizes_px, kind="stable")[:_STRONG]] for one in features]
    order = [np.argsort(-one.sizes_px, kind="stable")[:_STRONG] for one in features]

    def compare(pair: Pair) -> Indices:
        found = match_descriptors(strong[pair[0]], strong[pair[1]], _STRONG_RATIO)
        return np.column_stack([order[pair[0]][found[:, 0]], order[pair[1]][found[:, 1]]])

    every = list(combinations(range(len(photos)), 2))
    coarse = dict(zip(every, side_by_side(compare, every, lambda part: advanced(0.4 + 0.05 * part)), strict=True))
    unused = repeated(photos, features, coarse)
    unused |= {index: one for index, one in blurred(photos, features).items() if index not in unused}
    check_count([photo.name for photo in photos], list(unused.values()))
    used = [index for index in range(len(photos)) if index not in unused]
    alike = {pair: len(coarse[pair]) for pair in every if not unused.keys() & set(pair)}
    kept = [photos[index] for index in used]
    kept_features = [features[index] for index in used]
    views = [view_of(photo, one) for photo, one in zip(kept, kept_features, strict=True)]
    cameras = cameras_of(views)
    place = {index: number for number, index in enumerate(used)}

    def verify(pair: Pair) -> pycolmap.TwoViewGeometry | None:
        first, second = (kept_features[index].descriptors for index in pair)
        found = match_descriptors(first, second)
        return verified(views, cameras, pair, found)

    chosen = [(place[first], place[second]) for first, second in _worth_matching(used, alike)]
    geometries = zip(chosen, side_by_side(verify, chosen, lambda part: advanced(0.45 + 0.55 * part)), strict=True)
    pairs = {pair: geometry for pair, geometry in geometries if geometry is not None}
    return Matched(kept, kept_features, views, cameras, pairs), unused


def _worth_matching(used: Sequence[int], alike: Mapping[Pair, int]) -> list[Pair]:
    """Return the pairs of photos that are next to each other in the walk or most alike."""
    chosen = {pair for step in range(1, _NEXT + 1) for pair in zip(used, used[step:], strict=False)}
    for index in used:
        others = sorted((pair for pair in alike if index in pair), key=lambda pair: (-alike[pair], pair))
        chosen |= set(others[:_ALIKE])
    return sorted(chosen)


def _largest(
    matched: Matched, advanced: Callable[[float], None]
) -> tuple[pycolmap.Reconstruction, list[pycolmap.Reconstruction]]:
    """Return the model with most photos, and the others."""
    count = 2

    def registered() -> None:
        nonlocal count
        count += 1
        advanced(min(count / len(matched.photos), 1.0))

    flat = [shows_no_parallax(geometry) for geometry in matched.pairs.values()]
    cache = cache_of(matched.views, matched.cameras, matched.pairs)
    models = reconstruct(cache, registered)
    flat_share = float(np.mean(flat)) if flat else 0.0
    if _most_photos(models) <= len(matched.photos) / 2 and flat_share <= _FLAT_SHARE:
        models = max(models, reconstruct(cache, registered, few_matches=True), key=_most_photos)
    if models and contradicts(models[0], matched):
        cache = cache_of(matched.views, matched.cameras, without_weak(matched.pairs))
        models = reconstruct(cache, registered)
    largest = _most_photos(models)
    if largest < MIN_PHOTOS or _spread(models[0]) < _LEAST_SPREAD:
        if len(flat) >= len(matched.photos) - 1 and (flat_share > _FLAT_SHARE or largest >= MIN_PHOTOS):
            raise no_parallax(matched.names)
        together = indices_of(models[0]) if models else []
        raise too_little_overlap(matched.names, [matched.names[index] for index in together])
    return models[0], models[1:]


def _most_photos(models: Sequence[pycolmap.Reconstruction]) -> int:
    return max((model.num_reg_images() for model in models), default=0)


def _spread(model: pycolmap.Reconstruction) -> float:
    """Measure the distance between the farthest two cameras over their distance from the points."""
    centres, points = _centres(model), _points(model)
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2).max()
    return float(apart / max(unit_scale(centres, points)[1], 1e-12)) if len(points) else 0.0


def _without_camera(
    matched: Matched, model: pycolmap.Reconstruction, others: Sequence[pycolmap.Reconstruction]
) -> Iterator[UnusedPhoto]:
    """Say why photos have no camera in the model."""
    have = set(indices_of(model))
    for index in sorted(set(range(len(matched.photos))) - have):
        groups = [indices_of(other) for other in others if index in indices_of(other)]
        group = [matched.names[one] for one in (groups[0] if groups else ()) if one != index and one not in have]
        yield without_camera(matched.names[index], group)


def _structure(
    matched: Matched, model: pycolmap.Reconstruction, order: Sequence[str], unused: Sequence[UnusedPhoto]
) -> Structure:
    """Return a model as a structure with Y up."""
    used = indices_of(model)
    turns = np.array([_turn(model, matched.views[index], index) for index in used])
    centres, points = _centres(model), _points(model)
    upright = upright_turn(up_direction(turns, centres, points))
    middle, scale = unit_scale(centres, points)
    solved = []
    for index, turn, centre in zip(used, turns, centres, strict=True):
        photo = matched.photos[index]
        height, width = photo.picture.shape[:2]
        focal, _, _, radial = model.camera(model.image(index + 1).camera_id).params
        rotation = turn @ upright.T
        pose = np.column_stack([rotation, -rotation @ (upright @ (centre - middle) / scale)])
        camera = PerspectiveCamera(width, height, pose, float(focal), (width / 2, height / 2))
        solved.append(SolvedPhoto(photo.name, camera, float(radial)))
    cloud = _cloud(matched, model, used, (points - middle) / scale @ upright.T)
    cloud = cloud.select(confirmed(cloud.points, cloud.seen, np.array([photo.camera.centre for photo in solved])))
    place = {name: number for number, name in enumerate(order)}
    return Structure(tuple(solved), cloud, tuple(sorted(unused, key=lambda one: place[one.name])))


def _turn(model: pycolmap.Reconstruction, view: View, index: int) -> Floats:
    """Return the rotation (3, 3) from the world to the camera of the upright photo."""
    return np.asarray(view.turn.T @ model.image(index + 1).cam_from_world().rotation.matrix())


def _centres(model: pycolmap.Reconstruction) -> Floats:
    return np.array([model.image(index + 1).projection_center() for index in indices_of(model)])


def _points(model: pycolmap.Reconstruction) -> Floats:
    """Return the model's points (n, 3) in the order of their ids."""
    return np.array([model.point3D(number).xyz for number in sorted(model.point3D_ids())]).reshape(-1, 3)


def _cloud(matched: Matched, model: pycolmap.Reconstruction, used: Sequence[int], points: Floats) -> PointCloud:
    """Return the model's points, moved to ``points``, with their colours: the mean of those in the photos."""
    column = {index + 1: number for number, index in enumerate(used)}
    rows = [
        (row, element.image_id, element.point2D_idx)
        for row, number in enumerate(sorted(model.point3D_ids()))
        for element in model.point3D(number).track.elements
    ]
    point, image, feature = np.array(rows, np.int64).reshape(-1, 3).T
    seen = np.zeros((len(points), len(used)), bool)
    total = np.zeros((len(points), 3))
    for number in column:
        of_image = image == number
        picture, places = matched.photos[number - 1].picture, matched.features[number - 1].points_px[feature[of_image]]
        x, y = np.floor(places).astype(np.int64).T
        height, width = picture.shape[:2]
        seen[point[of_image], column[number]] = True
        np.add.at(total, point[of_image], picture[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)])
    counted = np.maximum(np.bincount(point, minlength=len(points)), 1)
    return PointCloud(points, np.round(total / counted[:, None]).astype(np.uint8), seen)
