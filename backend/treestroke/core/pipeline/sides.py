"""The left side of a tree, scaled to its front, from which depth is taken."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.lift.retrieval import PAIRED, retrieve_depth
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Sketch
from treestroke.core.survey.fidelity import fidelity
from treestroke.core.trace.drawing import Drawing, trace_sketch
from treestroke.core.types import Indices

UNITS = 1000.0
"""Height of a tree, root to top, in which sketches are compared."""
MARGIN = 0.02
"""Empty border around a crown's mask, as a share of the tree's height."""


@dataclass(frozen=True, eq=False)
class Side:
    """The left side, scaled so that its heights are those of the front.

    Attributes
    ----------
    tree
        Its 2D skeleton, in `UNITS` of the tree's height: Z to the right, y up, root at the origin.
    crown
        Its crown as a camera sees it that looks along +X.
    """

    tree: Branched
    crown: Silhouette[OrthographicCamera]


def draw_side(sketch: Sketch, place: str) -> Drawing:
    """Read one of several sketches; errors and warnings name its ``place``.

    Raises
    ------
    StrokesError
        The sketch does not describe a tree.
    """
    try:
        drawing = trace_sketch(sketch)
    except StrokesError as error:
        raise StrokesError(f"{place}: {error}", code=error.code, pointer=f"/{place}{error.pointer}") from error
    warnings = tuple(replace(warning, stroke=f"{place}/{warning.stroke}") for warning in drawing.warnings)
    return replace(drawing, warnings=warnings)


def stroke_height(drawing: Drawing) -> float:
    """Measure from the root to the topmost stroke, px."""
    rows = drawing.tree.skeleton.points[:, 1]
    return max(float(rows[0] - rows.min()), 1.0)


def crown_height(drawing: Drawing) -> float:
    """Measure from the root to the crown's top, or to the topmost stroke where that is higher, px."""
    root = float(drawing.tree.skeleton.points[0, 1])
    return max(root - float(drawing.crown[:, 1].min()), stroke_height(drawing))


def in_units(tree: Branched, height_px: float) -> Branched:
    """Bring a 2D skeleton, px, to `UNITS`: from the root, y up."""
    scale, skeleton = UNITS / height_px, tree.skeleton
    points = (skeleton.points - skeleton.points[0]) * np.array([scale, -scale])
    return Branched(Skeleton(points, skeleton.radii * scale, skeleton.parents), tree.branch)


def side_of(
    drawing: Drawing, height_of: Callable[[Drawing], float], front_height_px: float, front: OrthographicCamera
) -> Side:
    """Scale the left side to the tree's height in the front's picture; ``height_of`` measures the side's height, px."""
    height_px = height_of(drawing)
    scale = front_height_px / height_px
    margin = MARGIN * front_height_px
    root, crown = drawing.tree.skeleton.points[0] * scale, drawing.crown * scale
    corner = np.floor(np.minimum(crown.min(axis=0), root) - margin)
    width, height = (np.ceil(np.maximum(crown.max(axis=0), root) + margin) - corner).astype(int).tolist()
    root_px = float(root[0] - corner[0]), float(root[1] - corner[1])
    camera = replace(front, width=width, height=height, root_px=root_px, from_left=True)
    return Side(in_units(drawing.tree, height_px), Silhouette(fill_outline(crown - corner, height, width), camera))


@dataclass(frozen=True, eq=False)
class RetrievedTree:
    """A front turned into a 3D tree by its left side.

    Attributes
    ----------
    tree
        (n joints) metres.
    front
        (n,) the front's joint that each stands for.
    score
        How well it matches both sketches, by name.
    """

    tree: Branched
    front: Indices
    score: dict[str, float]


def with_depth(front: Branched, side: Side, height_px: float, camera: OrthographicCamera) -> RetrievedTree:
    """Turn a front (px of a camera) into a 3D tree by the depth of its left side."""
    flat = in_units(front, height_px)
    retrieved = retrieve_depth(flat, side.tree)
    skeleton, metres = retrieved.tree.skeleton, float(camera.metres_from_pixels(height_px / UNITS))
    root = camera.world_from_pixels(front.skeleton.points[:1])
    tree = Skeleton(root + skeleton.points * metres, skeleton.radii * metres, skeleton.parents)
    score = asdict(fidelity(flat, side.tree, retrieved.tree, retrieved.origin == PAIRED))
    return RetrievedTree(Branched(tree, retrieved.tree.branch), retrieved.front, score)
