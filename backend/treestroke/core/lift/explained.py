"""Keeps the branches without which the shots would not look as they do."""

import heapq
from collections.abc import Sequence

import numpy as np

from treestroke.core.lift.centre_lines import CentreLines
from treestroke.core.lift.point_graph import PointGraph
from treestroke.core.lift.thin_hull import ShownArea
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Indices, Mask

OWN_SHARE, OWN_BARE = 0.15, 0.2
"""Least share of a branch's pixels, in the mean over the shots, that no other branch covers. On a bare oak of 18 shots
0.05 keeps 346 branches (24 % of their length false), 0.15 keeps 202 (183 are true), with as much of the true ones; with
estimated mattes the silhouettes of a bare tree are better by 0.2, and a leafy one loses true branches."""
SPREAD_PX = 1.0
"""Least radius of a branch in a shot, px."""


def explained(lines: CentreLines, graph: PointGraph, areas: Sequence[ShownArea], least: float = OWN_SHARE) -> Mask:
    """Tell which paths (k,) are needed to explain what the shots show.

    Where silhouettes agree by chance, the pixels belong to other branches too. Paths go one by one, that of the least
    own share first, ends before what bears them, until each of those left explains ``least`` of its pixels alone.
    Source: explaining away, Pearl 1988; in silhouettes, Franco and Boyer 2009.
    """
    pixels, first = _footprints(lines, graph, areas)
    covered = np.zeros(sum(area.shown.size for area in areas), dtype=np.int32)
    np.add.at(covered, pixels, 1)
    bears = np.bincount(lines.parents[lines.parents >= 0], minlength=len(lines.paths))
    kept = np.ones(len(lines.paths), dtype=np.bool_)

    def own(path: int) -> float:
        """Share of a path's pixels that it alone covers; none where it covers no pixel."""
        counts = covered[pixels[first[path] : first[path + 1]]]
        return float((counts == 1).sum() / max(len(counts), 1))

    waiting = [(own(path), path) for path in np.flatnonzero(bears == 0).tolist()]
    heapq.heapify(waiting)
    while waiting:
        before, path = heapq.heappop(waiting)
        share, parent = own(path), int(lines.parents[path])
        if share > before:
            heapq.heappush(waiting, (share, path))
            continue
        if share >= least or parent < 0:
            break
        kept[path] = False
        covered[pixels[first[path] : first[path + 1]]] -= 1
        bears[parent] -= 1
        if bears[parent] == 0:
            heapq.heappush(waiting, (own(parent), parent))
    return kept


def _footprints(lines: CentreLines, graph: PointGraph, areas: Sequence[ShownArea]) -> tuple[Indices, Indices]:
    """List the pixels of all shots that each path covers, path after path, and where each path begins (k + 1)."""
    places = np.concatenate(lines.paths)
    owner = np.repeat(np.arange(len(lines.paths)), [len(path) for path in lines.paths])
    found = side_by_side(lambda area: _footprint(graph.points[places], graph.radii[places], owner, area), areas)
    start = 0
    for area, (_, pixels) in zip(areas, found, strict=True):
        pixels += start
        start += area.shown.size
    owners, pixels = (np.concatenate(column) for column in zip(*found, strict=True))
    order = np.argsort(owners, kind="stable")
    return pixels[order], np.searchsorted(owners[order], np.arange(len(lines.paths) + 1))


def _footprint(points: Floats, radii_m: Floats, owner: Indices, area: ShownArea) -> tuple[Indices, Indices]:
    """List the pairs of owner and shown pixel (flat index) of discs about points (n, 3) with radii (n,), metres."""
    places = np.floor(area.shot.camera.pixels_from_world(points)).astype(np.int64)
    radii = np.maximum(np.rint(radii_m / area.shot.camera.pixel_size(points)), SPREAD_PX).astype(np.int64)
    found = [
        _covered(places[radii == radius], owner[radii == radius], int(radius), area.shown)
        for radius in np.unique(radii)
    ]
    whose, pixel = np.divmod(_distinct(np.concatenate(found)), area.shown.size)
    return whose, pixel


def _covered(places: Indices, owner: Indices, radius: int, shown: Mask) -> Indices:
    """List the shown pixels in discs of a radius, px, about places (n, 2), as owner times pixels plus pixel."""
    reach = np.arange(-radius, radius + 1)
    across, down = (offset.ravel() for offset in np.meshgrid(reach, reach))
    disc = across**2 + down**2 <= (radius + 0.5) ** 2
    column, row = (places[:, :1] + across[disc]).ravel(), (places[:, 1:] + down[disc]).ravel()
    height, width = shown.shape
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    inside[inside] = shown[row[inside], column[inside]]
    whose = np.repeat(owner, int(disc.sum()))[inside]
    return _distinct(whose * shown.size + row[inside] * width + column[inside])


def _distinct(numbers: Indices) -> Indices:
    """Sort numbers (n,) and leave out repeated ones; faster here than ``np.unique``, which hashes."""
    numbers = np.sort(numbers)
    return np.asarray(numbers[np.append(True, np.diff(numbers) > 0)[: len(numbers)]])
