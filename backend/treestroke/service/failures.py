"""Why a model failed, in words for the person who waits for it."""

from typing import Any

import cv2

from treestroke.core.errors import TreestrokeError

_DETAILS = {
    "worker_lost": ("The process that grew the tree was lost three times. Try again; if it stays so, report it.", True),
    "time_limit": ("The tree took longer to grow than this service allows. Try fewer iterations.", False),
    "out_of_memory": ("The tree needs more memory than this service allows. Try a smaller photo.", False),
    "storage_error": ("The service could not store the tree: its disk may be full. Try again later.", True),
    "input_damaged": (
        "A stored file that the tree is made of is damaged or gone. Upload the photo again, and ask for a new model.",
        False,
    ),
    "engine_error": ("The tree could not be grown; this is our mistake, and it is in the log.", False),
}


def problem_of(code: str) -> dict[str, Any]:
    """Say a failure as plain values: ``code``, ``detail``, and whether it may help to try again."""
    detail, retryable = _DETAILS[code]
    return {"code": code, "detail": detail, "retryable": retryable}


def problem_of_input(error: TreestrokeError) -> dict[str, Any]:
    """Say what is wrong with the input."""
    return {"code": "input_unusable", "detail": str(error), "retryable": False}


def ran_out_of_memory(error: Exception) -> bool:
    """Tell whether an error means that memory ran out: OpenCV says so in a way of its own."""
    return isinstance(error, MemoryError) or (isinstance(error, cv2.error) and error.code == cv2.Error.StsNoMem)
