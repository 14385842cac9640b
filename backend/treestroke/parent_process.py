"""What a parent process tells its children, and children that end when their parent ends, however it ends."""

import os
import signal
import threading
import time

PARENT_HOLDS_STDIN = "PARENT_HOLDS_STDIN"
"""Environment variable: the parent keeps this process's standard input open for as long as it lives."""
LISTENER = "LISTEN_FD"
"""Environment variable: the descriptor of the socket on which the web process listens."""
RUN_ID, PREVIOUS_RUN_ID = "RUN_ID", "PREVIOUS_RUN_ID"
"""Environment variables: the id of this run of a process that is restarted, and of the run before it, which ended."""
_POLL_SECONDS = 0.5


def stop_with_parent() -> None:
    """Send this process SIGTERM as soon as its parent ends, if the parent holds its standard input."""
    if os.environ.pop(PARENT_HOLDS_STDIN, None):
        threading.Thread(target=_wait_for_end_of_stdin, name="parent-process", daemon=True).start()


def _wait_for_end_of_stdin() -> None:
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


def kill_with_parent(parent: int) -> None:
    """Kill this process soon after ``parent``, its parent's process id, ended: nothing limits its time any more."""
    threading.Thread(target=_wait_for_parent, args=(parent,), name="parent-process", daemon=True).start()


def _wait_for_parent(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_POLL_SECONDS)
    os.kill(os.getpid(), signal.SIGKILL)
