"""Traces of stored captures: asked of the process that traces captures."""

from treestroke.service import capture_tracer
from treestroke.service.capture_photos import warnings_of
from treestroke.service.captures import find_capture, solved_structure
from treestroke.service.photos import Resources


def trace_capture(resources: Resources, id: str, body: bytes) -> bytes:
    """Trace a solved capture by the body of a request; return the response's JSON.

    Raises
    ------
    NotFound, CaptureError, StrokesError, SettingsError
        There is no such capture, it is not solved, or the body cannot be used.
    Damaged
        A file of it is damaged.
    Overloaded, Crashed
        Too many captures are being traced, or the process died over this request.
    """
    capture = find_capture(resources.database, id)
    structure = resources.blobs.check(solved_structure(capture))
    photos = [
        capture_tracer.StoredPhoto(photo.name, (photo.width, photo.height), resources.blobs.check(photo.blob))
        for photo in capture.photos
    ]
    mended = warnings_of(capture.photos)
    return resources.capture_tracers("", capture_tracer.trace_answer, structure, photos, body, mended)
