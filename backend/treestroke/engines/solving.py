"""Structure from motion in a process of its own: COLMAP may crash or take too long.

This process does not import pycolmap: its zlib would stand in for OpenCV's where it comes first, and PNG files break.
"""

from collections.abc import Sequence
from typing import Literal

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.progress import Report, silent
from treestroke.engines.child import Bounds, ChildEnded, call_in_child


class SolveEnded(Exception):
    """The process ended before it had a result.

    Attributes
    ----------
    why
        It took too long (``slow``), ran out of memory (``memory``) or died (``crash``).
    """

    def __init__(self, why: Literal["slow", "memory", "crash"]) -> None:
        super().__init__(
            {
                "slow": "finding the cameras took too long; give fewer photos",
                "memory": "finding the cameras ran out of memory; give fewer photos",
                "crash": "the process that finds the cameras died",
            }[why]
        )
        self.why = why


def solve_in_process(photos: Sequence[CapturedPhoto], bounds: Bounds, report: Report = silent) -> Structure:
    """Do what `treestroke.engines.structure.solve` does in a process of its own, and end it whatever happens.

    An exception that ``report`` raises ends the work; with this process the other one ends too.

    Raises
    ------
    CaptureError
        As `solve` does.
    SolveEnded
        The process took too long, ran out of memory or died.
    """
    try:
        structure: Structure = call_in_child("treestroke.engines.structure:solve", (photos,), bounds, report)
    except ChildEnded as ended:
        raise SolveEnded(ended.why) from ended
    return structure
