"""Processes that end with the one that started them, however that one ends, and what that one tells them."""

import os
import signal
import threading
import time

PARENT_HOLDS_STDIN = "PARENT_HOLDS_STDIN"
"""Set where the parent holds this process's standard input open as long as it lives."""
RUN_ID, PREVIOUS_RUN_ID = "RUN_ID", "PREVIOUS_RUN_ID"
"""Set by a parent that starts a process again and again: the name of this run, and of the one that ended before it."""

_LOOK_SECONDS = 0.5


def stop_with_parent() -> None:
    """Stop this process, as by SIGTERM, when its parent is gone."""
    if os.environ.pop(PARENT_HOLDS_STDIN, None):
        threading.Thread(target=_wait, name="lifeline", daemon=True).start()


def _wait() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def kill_with_parent(parent: int) -> None:
    """Kill this process, a child of ``parent``, soon after that one is gone: nobody bounds its time any more."""
    threading.Thread(target=_follow, args=(parent,), name="follow", daemon=True).start()


def _follow(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK_SECONDS)
    os.kill(os.getpid(), signal.SIGKILL)
