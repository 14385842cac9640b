"""Processes that end with the one that started them, however that one ends."""

import os
import signal
import threading

VARIABLE = "LIFELINE"
"""Set where the parent holds this process's standard input open as long as it lives."""


def hold_lifeline() -> None:
    """Stop this process, as by SIGTERM, when its parent is gone."""
    if os.environ.pop(VARIABLE, None):
        threading.Thread(target=_wait, name="lifeline", daemon=True).start()


def _wait() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)
