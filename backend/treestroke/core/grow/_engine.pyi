from typing_extensions import Buffer

class Engine:
    def __init__(
        self,
        size: tuple[int, int],
        mask: Buffer,
        middle: Buffer,
        radius: Buffer,
        foot: tuple[float, float, float],
        spacing: float,
        closeness: float,
        keep: float,
        inward_cosine: float,
        counts: Buffer,
        parents: Buffer,
        fractions: Buffer,
        vectors: Buffer,
    ) -> None: ...
    def add_branches(self, bases: Buffer, tips: Buffer, scales: Buffer) -> None: ...
    def add_attractors(self, points: Buffer, in_space: bool) -> None: ...
    def best(self, candidates: Buffer, in_space: bool) -> tuple[int, int, int, float]: ...
    def place(self, branch: int, subtree: int, angle: int) -> list[tuple[int, float, float, float, float, float, float, float]]: ...
    def distances(self) -> bytes: ...
