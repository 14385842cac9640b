"""Levels of detail in a glTF document: nodes that take the place of a node where it is small, by MSFT_lod."""

from collections.abc import Sequence

from treestroke.codec.gltf.book import Book

_LOD = "MSFT_lod"
_SCREEN_PX = (1920, 1080)
_HEIGHTS_PX = (400, 150, 64)
"""Heights of a tree on that screen from which on down the first level, the second and the impostor are shown."""


def add_levels(book: Book, node: int, coarser: Sequence[int], ends: bool) -> None:
    """Name the nodes that stand for ``node`` where it is small, from finer to coarser.

    Each node is told for itself, for a mesh that follows bones must stand in the scene's own list. The coarser nodes
    stand in no list, so readers without the extension show the finest alone. ``extras.MSFT_screencoverage`` gives
    the least share of the screen's area, by the square of the tree's height, for each level; the last stays to the
    end where ``ends``, else it leaves there to another node's impostor.

    Raises
    ------
    ValueError
        There are more levels than sizes at which they change.
    """
    if len(coarser) > len(_HEIGHTS_PX):
        raise ValueError(f"a node has at most {len(_HEIGHTS_PX)} coarser levels, got {len(coarser)}")
    shares = [round(height**2 / (_SCREEN_PX[0] * _SCREEN_PX[1]), 4) for height in _HEIGHTS_PX]
    least = [*shares[: len(coarser)], 0.0 if ends else shares[min(len(coarser), len(shares) - 1)]]
    row = book.tables["nodes"][node]
    row["extensions"] = {**row.get("extensions", {}), _LOD: {"ids": list(coarser)}}
    row["extras"] = {**row.get("extras", {}), "MSFT_screencoverage": least}
    book.used.add(_LOD)
