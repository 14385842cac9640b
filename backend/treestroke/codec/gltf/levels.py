"""Levels of detail in a glTF document: nodes that replace a node where it is small (MSFT_lod)."""

from collections.abc import Sequence

from treestroke.codec.gltf.document import Document

_LOD = "MSFT_lod"
_SCREEN_PX = (1920, 1080)
_HEIGHTS_PX = (400, 150, 64)
"""Heights of a tree on that screen below which the first level, the second and the impostor are shown."""


def add_levels(document: Document, node: int, coarser: Sequence[int], ends: bool) -> None:
    """Declare the nodes that replace ``node`` where it is small, from finer to coarser.

    Levels are declared for each node by itself, since a skinned mesh must be a root of the scene. The coarser nodes
    are no roots, so readers without the extension show the finest alone. ``extras.MSFT_screencoverage`` holds the least
    share of the screen's area for each level, by the square of the tree's height. If ``ends``, the last level is shown
    at any smaller size; otherwise it is hidden below the impostor's size, when another node shows the impostor.

    Raises
    ------
    ValueError
        There are more than three levels.
    """
    if len(coarser) > len(_HEIGHTS_PX):
        raise ValueError(f"a node has at most {len(_HEIGHTS_PX)} coarser levels, got {len(coarser)}")
    shares = [round(height**2 / (_SCREEN_PX[0] * _SCREEN_PX[1]), 4) for height in _HEIGHTS_PX]
    least = [*shares[: len(coarser)], 0.0 if ends else shares[min(len(coarser), len(shares) - 1)]]
    row = document.tables["nodes"][node]
    row["extensions"] = {**row.get("extensions", {}), _LOD: {"ids": list(coarser)}}
    row["extras"] = {**row.get("extras", {}), "MSFT_screencoverage": least}
    document.used.add(_LOD)
