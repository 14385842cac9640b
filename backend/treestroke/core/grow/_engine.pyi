import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices

class Engine:
    def __init__(
        self,
        size: tuple[int, int],
        mask: NDArray[np.uint8],
        middle: Floats,
        radius: Floats,
        foot: tuple[float, float, float],
        spacing: float,
        closeness: float,
        keep: float,
        inward_cosine: float,
        counts: Indices,
        parents: Indices,
        fractions: Floats,
        vectors: Floats,
    ) -> None: ...
    def add_branches(self, bases: Floats, tips: Floats, scales: Floats) -> None: ...
    def add_attractors(self, points: Floats, in_space: bool) -> None: ...
    def group(self, starts: Indices) -> None: ...
    def best(self, candidates: Indices, in_space: bool) -> tuple[int, int, int, float]: ...
    def place(
        self, branch: int, subtree: int, angle: int
    ) -> list[tuple[int, float, float, float, float, float, float, float]]: ...
    def distances(self) -> bytes: ...
