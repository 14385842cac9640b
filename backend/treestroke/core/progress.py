"""Progress of long work, reported without a clock."""

from collections.abc import Callable

Report = Callable[[str, float], None]
"""Called as ``report(stage, fraction)``: the stage's name and its own fraction done, 0 to 1."""


def silent(stage: str, fraction: float) -> None:
    """Report nothing."""
