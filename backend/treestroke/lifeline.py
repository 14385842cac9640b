"""Processes that end with the one that started them, however that one ends."""

import os
import signal
import threading
import time

VARIABLE = "LIFELINE"
"""Set where the parent holds this process's standard input open as long as it lives."""

_LOOK_SECONDS = 0.5


def hold_lifeline() -> None:
    """Stop this process, as by SIGTERM, when its parent is gone."""
    if os.environ.pop(VARIABLE, None):
        threading.Thread(target=_wait, name="lifeline", daemon=True).start()


def _wait() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def end_with(parent: int) -> None:
    """Kill this process, a child of ``parent``, soon after that one is gone: nobody bounds its time any more."""
    threading.Thread(target=_follow, args=(parent,), name="follow", daemon=True).start()


def _follow(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK_SECONDS)
    os.kill(os.getpid(), signal.SIGKILL)
