"""The first half of the recipe for many photos: from photos with their cameras to a grown tree (Tan et al. 2007)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from treestroke.core.capture import CapturedPhoto, PointCloud, Shot, SolvedPhoto, Structure, TreeMatte, UnusedPhoto
from treestroke.core.carve.carving import carved, with_points
from treestroke.core.carve.dense_points import dense_cloud
from treestroke.core.carve.measured import measured_crown
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import Camera, OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.measured_crown import MeasuredCrown
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.replication import CrownBounds, ReplicationParams, grow_hidden
from treestroke.core.lift.seen_branches import SeenBranches, seen_branches
from treestroke.core.pipeline.captured_photos import fitted
from treestroke.core.pipeline.drawn_views import check_used, mend_views
from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import DOUBTFUL
from treestroke.core.pipeline.grown_tree import CapturedViews, GrownTree, LiveTree, Reading
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.shown_kinds import odds_by_shots
from treestroke.core.pipeline.taken import Taken
from treestroke.core.pipeline.tree_frame import cloud_in_frame, height_above, in_frame, shows_tree, tree_frame
from treestroke.core.pipeline.view_appearance import view_appearance
from treestroke.core.progress import Report, silent
from treestroke.core.segment.view_mattes import view_mattes
from treestroke.core.strokes import CaptureStrokes, LengthInPhoto, Stroke, Strokes, StrokeWarning
from treestroke.core.survey.measures import Scale, Stature
from treestroke.core.types import Floats
from treestroke.core.undistortion import undistorted, undistorted_points

FRAME_SIDE = 1200
"""Side, px, of the picture in which the front is drawn."""
FRAME_FILLED = 0.85
"""Share of that picture's height that the tree takes."""
READ = "the tree as it was read in each photo that is used"


@dataclass(frozen=True, eq=False)
class ViewsEvidence:
    """What the photos of a capture show of its tree, in the tree's frame, metres.

    Attributes
    ----------
    photos
        The captured photos that are used, in the order of the shots.
    structure
        Their cameras, and which photos are not used.
    shots, mattes
        The photos free of distortion, and where each shows the tree.
    cloud
        Points on the tree.
    crown
        The measured crown.
    seen
        The branches that are seen.
    front
        The shot that the tree's front is, and what it shows by itself.
    known
        Whether a length that was drawn, or a distance, sets the scale.
    height_m
        The height, metres, of a tree without a scale.
    frame
        The change from the structure's frame to the tree's.
    edited
        What became of edits that could not be applied.
    """

    photos: tuple[CapturedPhoto, ...]
    structure: Structure
    shots: tuple[Shot, ...]
    mattes: tuple[TreeMatte, ...]
    cloud: PointCloud
    crown: MeasuredCrown
    seen: SeenBranches
    front: PhotoEvidence
    known: bool
    height_m: float
    frame: Similarity
    edited: tuple[StrokeWarning, ...] = ()

    @property
    def warnings(self) -> tuple[StrokeWarning, ...]:
        """What was mended, and which photos are not used."""
        unused = (StrokeWarning(photo.code, f"photos/{photo.name}", photo.detail) for photo in self.structure.unused)
        return (*self.front.warnings, *unused, *self.edited)


def read_views(
    photos: Sequence[CapturedPhoto],
    structure: Structure,
    drawn: CaptureStrokes,
    height_m: float,
    report: Report = silent,
) -> ViewsEvidence:
    """Find the tree in all photos of a capture, its crown and the branches that are seen.

    ``drawn`` is in px of the upright photos; a tree without a scale is ``height_m`` high.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree, or lie on a photo that is not there or not used.
    CaptureError
        The structure is of other photos.
    """
    report("mattes", 0.0)
    structure, by_name = fitted(structure, photos), {photo.name: photo for photo in photos}
    drawn = mend_views(drawn, {photo.name: photo.size_px for photo in photos})
    shots = tuple(undistorted(by_name[solved.name].picture, solved) for solved in structure.photos)
    drawn = _on_shots(drawn, by_name, structure)
    frame = tree_frame({shot.name: shot.camera for shot in shots}, structure.cloud, drawn, height_m)
    shots, cloud = tuple(in_frame(shot, frame) for shot in shots), cloud_in_frame(structure.cloud, frame)
    structure, shots, cloud = _of_tree(photos, structure, shots, cloud, _drawn_height(shots, drawn))
    names = [shot.name for shot in shots]
    drawn = replace(drawn, by_photo={name: one for name, one in drawn.by_photo.items() if name in names})
    mattes = view_mattes(shots, {names.index(name): one for name, one in drawn.by_photo.items()}, cloud, report)
    if drawn.scale is None:
        larger = Similarity(np.zeros(3), np.eye(3), height_m / _seen_height(shots, mattes))
        shots, cloud = tuple(in_frame(shot, larger) for shot in shots), cloud_in_frame(cloud, larger)
        frame = frame.then(larger)
    carving = carved(shots, mattes, report)
    cloud = dense_cloud(carving, shots, mattes, report)
    crown = measured_crown(with_points(carving, shots, cloud), shots)
    seen = seen_branches(shots, mattes, cloud, report)
    return ViewsEvidence(
        photos=tuple(by_name[name] for name in names),
        structure=structure,
        shots=shots,
        mattes=mattes,
        cloud=cloud,
        crown=crown,
        seen=seen,
        front=_front(drawn, shots, mattes, crown),
        known=drawn.scale is not None,
        height_m=height_m,
        frame=frame,
    )


def _front(
    drawn: CaptureStrokes, shots: Sequence[Shot], mattes: Sequence[TreeMatte], crown: MeasuredCrown
) -> PhotoEvidence:
    """Return what the front shows by itself; what its twigs bear is told by several shots."""
    shot = next(shot for shot in shots if shot.name == drawn.first)
    front = read_photo(shot.picture, drawn.by_photo[drawn.first])
    return replace(front, odds=odds_by_shots(front.odds, shots, mattes, crown))


def _on_shots(drawn: CaptureStrokes, photos: Mapping[str, CapturedPhoto], structure: Structure) -> CaptureStrokes:
    """Return the strokes over photos that are used, in px of their shots.

    Raises
    ------
    StrokesError
        The photo with the trunk stroke, or one that the scale names, is not used.
    """
    carriers = {
        solved.name: partial(_carried, reduction=photos[solved.name].reduction, solved=solved)
        for solved in structure.photos
    }
    check_used(drawn, carriers)
    by_photo = {name: _moved(strokes, carriers[name]) for name, strokes in drawn.by_photo.items() if name in carriers}
    scale = drawn.scale
    if isinstance(scale, LengthInPhoto):
        points = carriers[scale.photo](scale.length.points)
        scale = replace(scale, length=replace(scale.length, points=points))
    return CaptureStrokes(by_photo, scale)


def _carried(points_px: Floats, *, reduction: float, solved: SolvedPhoto) -> Floats:
    """Carry points (n, 2), px of the upright photo, to px of its shot."""
    return undistorted_points(points_px * reduction, solved)


def _moved(strokes: Strokes, carry: Callable[[Floats], Floats]) -> Strokes:
    """Return strokes with their points carried to another picture; widths follow the scale at their first point."""

    def moved(stroke: Stroke) -> Stroke:
        points = carry(stroke.points)
        if stroke.width is None:
            return Stroke(points)
        beside = carry(stroke.points[:1] + np.array([stroke.width, 0.0]))
        return Stroke(points, float(np.linalg.norm(beside - points[:1])))

    return Strokes(
        crown=moved(strokes.crown),
        branches=tuple(moved(stroke) for stroke in strokes.branches),
        erase=tuple(moved(stroke) for stroke in strokes.erase),
    )


def _drawn_height(shots: Sequence[Shot], drawn: CaptureStrokes) -> float:
    """Return the height of the crown stroke's top above the root, metres."""
    camera = next(shot.camera for shot in shots if shot.name == drawn.first)
    crown = drawn.by_photo[drawn.first].crown.points
    return height_above(camera, np.zeros(3), crown[crown[:, 1].argmin()])


def _of_tree(
    photos: Sequence[CapturedPhoto], structure: Structure, shots: tuple[Shot, ...], cloud: PointCloud, height_m: float
) -> tuple[Structure, tuple[Shot, ...], PointCloud]:
    """Leave out the photos that look past the tree, such as those of another tree in the same place."""
    shown = np.array([shows_tree(shot.camera, height_m) for shot in shots])
    if shown.all():
        return structure, shots, cloud
    past = [_past_tree(shot.name) for shot, of_tree in zip(shots, shown, strict=True) if not of_tree]
    place = {photo.name: index for index, photo in enumerate(photos)}
    kept = Structure(
        tuple(photo for photo, of_tree in zip(structure.photos, shown, strict=True) if of_tree),
        replace(structure.cloud, seen=structure.cloud.seen[:, shown]),
        tuple(sorted([*structure.unused, *past], key=lambda one: place.get(one.name, -1))),
    )
    of_shots = tuple(shot for shot, of_tree in zip(shots, shown, strict=True) if of_tree)
    return kept, of_shots, replace(cloud, seen=cloud.seen[:, shown])


def _past_tree(name: str) -> UnusedPhoto:
    detail = f"{name} does not show the tree that was drawn: leave it out, or make a capture of its own of another tree"
    return UnusedPhoto(name, "other_tree", detail)


def _seen_height(shots: Sequence[Shot], mattes: Sequence[TreeMatte]) -> float:
    """Return the height of the tree's top above its root, metres: the median of what the shots show."""
    heights = []
    for shot, matte in zip(shots, mattes, strict=True):
        rows, columns = np.nonzero(matte.tree)
        if len(rows):
            top_px = np.array([float(np.median(columns[rows == rows.min()])) + 0.5, float(rows.min())])
            heights.append(height_above(shot.camera, np.zeros(3), top_px))
    if not heights:
        raise StrokesError.at(("views",), "no tree was found inside the crown; draw it around the tree", "no_tree")
    return float(np.median(heights))


def grow_views(
    evidence: ViewsEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Let the branches that no photo shows fill the measured crown, and gather what the tree looks like."""
    taken, shots, mattes = evidence.front.taken(settings), evidence.shots, evidence.mattes
    grown = _with_hidden(evidence, settings, rng, report)
    appearance = view_appearance(shots, mattes, grown.skeleton, taken.foliage != "bare")
    camera = _front_camera(evidence.crown)
    scale = Scale(float(camera.metres_from_pixels(1.0)), evidence.known, 0.0)
    top = float(evidence.crown.bounds[1, 1])
    return GrownTree(
        taken=taken,
        grown=grown,
        volume=evidence.crown,
        appearance=appearance,
        camera=camera,
        expected=tuple(Silhouette[Camera](matte.tree, shot.camera) for shot, matte in zip(shots, mattes, strict=True)),
        stature=Stature(top, scale, True, evidence.crown),
        score={},
        reading=_reading(evidence, taken),
        warnings=evidence.warnings,
        captured=_captured(evidence),
    )


def live_views(evidence: ViewsEvidence, settings: ModelSettings, rng: np.random.Generator) -> LiveTree:
    """Let the tree grow as `grow_views` does, without what it looks like."""
    grown = _with_hidden(evidence, settings, rng, silent)
    return LiveTree(grown.skeleton, grown.born, _front_camera(evidence.crown))


def _with_hidden(evidence: ViewsEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report) -> Grown:
    """Return the visible branches with those that no photo shows."""
    report("grow", 0.0)
    silhouettes = tuple(
        Silhouette[Camera](matte.tree | matte.hidden, shot.camera)
        for shot, matte in zip(evidence.shots, evidence.mattes, strict=True)
    )
    bounds = CrownBounds(evidence.crown, silhouettes, evidence.seen.leaf_points, float(evidence.crown.bounds[1, 1]))
    return grow_hidden(evidence.seen.skeleton, bounds, ReplicationParams(settings.iterations), rng, report)


def _front_camera(crown: MeasuredCrown) -> OrthographicCamera:
    """Return a level camera of the front whose picture holds the tree."""
    (left, _, _), (right, top, _) = crown.bounds.tolist()
    across = max(2 * max(abs(left), abs(right)), top)
    metres_per_pixel = across / (FRAME_FILLED * FRAME_SIDE)
    root_y = 0.5 * (FRAME_SIDE + top / metres_per_pixel)
    return OrthographicCamera(FRAME_SIDE, FRAME_SIDE, metres_per_pixel, (FRAME_SIDE / 2, root_y))


def _captured(evidence: ViewsEvidence) -> CapturedViews:
    """Return the cameras of the photos at their own sizes."""
    names = tuple(photo.name for photo in evidence.photos)
    cameras = tuple(
        shot.camera.resized(*photo.size_px) for photo, shot in zip(evidence.photos, evidence.shots, strict=True)
    )
    return CapturedViews(names, cameras, evidence.structure.unused)


def _reading(evidence: ViewsEvidence, taken: Taken) -> Reading:
    """Return what the score is measured against, and what makes that doubtful."""
    codes = [warning.code for warning in evidence.front.warnings]
    return Reading(READ, tuple(code for code in codes if code in DOUBTFUL) + ("kind_unsure",) * taken.ask)
