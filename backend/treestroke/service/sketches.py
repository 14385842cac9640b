"""Sketches, traced while they are drawn."""

from treestroke.service import tracer
from treestroke.service.photos import Shelf


def trace_sketches(shelf: Shelf, body: bytes) -> bytes:
    """Trace sketches by a request's body; give the answer's JSON.

    Raises
    ------
    TreestrokeError
        The body cannot be used.
    Overloaded, Crashed
        The tracing processes have too much to do, or one died over this.
    """
    return shelf.tracers("", tracer.sketch_answer, body)
