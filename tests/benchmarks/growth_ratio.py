"""Run growth by the plain reference and by the engine in one process; print how many times faster the engine is.

The case is that of the measurements behind the design: a crown of 900 by 800 px, a trunk, six limbs and two side
limbs, 2,000 attractors, 20 candidates, 8 subtrees, 12 angles, 20 iterations. As a script its last line is
``growth ratio N``.
"""

import sys
import time

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.compiled import CompiledEvaluator
from treestroke.core.grow.growing import Growing, rules_for
from treestroke.core.grow.growth_space import growth_space
from treestroke.core.grow.library import TYPE_1, TYPE_2, Subtree, visible_subtrees
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.reference import PlainEvaluator
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.grow.stem import foot_of
from treestroke.core.progress import silent
from treestroke.core.skeleton.skeleton import Skeleton

LIMBS = ((2, -55, 30), (2, 50, -35), (3, -40, -20), (3, 62, 30), (4, -65, 40), (4, 35, -30))
"""Trunk joint, degrees from upright in the photo, and out of it."""


def _limb(points: list[list[float]], parents: list[int], start: int, lean: float, out: float) -> None:
    """Append a limb of 260 px in five joints."""
    lean, out = np.radians(lean), np.radians(out)
    step = 52 * np.array([np.sin(lean) * np.cos(out), -np.cos(lean), np.sin(out)])
    for k in range(1, 6):
        parents.append(start if k == 1 else len(points) - 1)
        points.append(list(np.array(points[start]) + step * k) if k == 1 else list(np.array(points[-1]) + step))


def benchmark_tree() -> tuple[Skeleton, CrownToFill]:
    """Build the visible tree (metres) and its crown."""
    camera = OrthographicCamera(1100, 1500, 0.01, (550.0, 1450.0))
    points, parents = [[550.0, 1450.0, 0.0]], [-1]
    for k in range(1, 7):
        parents.append(k - 1)
        points.append([550.0 + 4 * (k % 2), 1450.0 - 145 * k, 0.0])
    limbs = [len(points) + 5 * i for i in range(len(LIMBS))]
    for joint, lean, out in LIMBS:
        _limb(points, parents, joint, lean, out)
    _limb(points, parents, limbs[0] + 2, -10, -40)
    _limb(points, parents, limbs[3] + 2, 15, 35)
    px = np.array(points)
    rows, columns = np.mgrid[0:1500, 0:1100] + 0.5
    mask = ((columns - 550) / 450) ** 2 + ((rows - 800) / 400) ** 2 <= 1
    world = camera.world_from_pixels(px[:, :2], -camera.metres_from_pixels(px[:, 2]))
    radii = 0.2 * 0.93 ** np.arange(len(px))
    front = Silhouette(mask, camera)
    return Skeleton(world, radii, np.array(parents)), CrownToFill(turned_outline(front), front)


def benchmark_library(skeleton: Skeleton) -> tuple[Subtree, ...]:
    """Take two or three subtrees of the visible tree and predefined ones, 8 in all."""
    return (visible_subtrees(skeleton) + TYPE_2 + TYPE_1)[:8]


def benchmark_growth(params: GrowthParams, make: type[CompiledEvaluator] | type[PlainEvaluator]) -> Growing:
    """Make the growth of the benchmark's tree, ready to run."""
    skeleton, to_fill = benchmark_tree()
    points = to_fill.front.camera.picture_space_from_world(skeleton.points)
    visible = Skeleton(points, skeleton.radii / 0.01, skeleton.parents)
    crown = growth_space(to_fill.volume, to_fill.front, foot_of(visible, to_fill.front.mask))
    library = benchmark_library(skeleton)
    return Growing(visible, crown, library, params, make(crown, library, rules_for(params, crown.unit)))


def timed(growing: Growing) -> tuple[float, list[tuple[int, int, int]]]:
    """Run a growth; give its CPU seconds and its choices."""
    start = time.process_time()
    choices = growing.run(np.random.default_rng(0), silent)
    return time.process_time() - start, choices


def main() -> None:
    """Print both times, the reference's rate, and last the ratio."""
    params = GrowthParams(iterations=20)
    timed(benchmark_growth(params, CompiledEvaluator))
    fast, chosen = min(timed(benchmark_growth(params, CompiledEvaluator)) for _ in range(5))
    plain = benchmark_growth(params, PlainEvaluator)
    slow, expected = timed(plain)
    if chosen != expected:
        sys.exit("growth ratio: the engine chose another sequence than the reference")
    pairs = plain.evaluator.pairs if isinstance(plain.evaluator, PlainEvaluator) else 0
    sys.stdout.write(f"reference {slow:.2f} s, {pairs / slow / 1e6:.0f} million point pairs a second\n")
    sys.stdout.write(f"engine {fast * 1000:.1f} ms\n")
    sys.stdout.write(f"growth ratio {slow / fast:.0f}\n")


if __name__ == "__main__":
    main()
