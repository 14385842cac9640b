"""A real `treestroke serve`, started and stopped for tests and benchmarks."""

import os
import re
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

BACKEND = Path(__file__).parents[1] / "backend"
FAR_LIMITS = {"trace_seconds": 300, "capture_trace_seconds": 1200, "model_seconds": 1800}
"""What is to end well ends well on a busy machine too."""


@contextmanager
def serving(data: Path, descriptors: int | None = None, **settings: object) -> Iterator[str]:
    """Run the service on a free port with settings by name, perhaps with few descriptors; give its address."""
    given = {f"TREESTROKE_{name.upper()}": str(value) for name, value in {**FAR_LIMITS, **settings}.items()}
    environment = {**os.environ, "PYTHONPATH": str(BACKEND), **given}
    command = [sys.executable, "-m", "treestroke", "serve", "--data", str(data), "--port", "0"]
    few = None if descriptors is None else partial(resource.setrlimit, resource.RLIMIT_NOFILE, (descriptors,) * 2)
    with (data.parent / f"{data.name}.log").open("wb") as log:
        process = subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, stderr=log, start_new_session=True, preexec_fn=few
        )
    try:
        assert process.stdout is not None
        said = process.stdout.readline().decode()
        found = re.search(r"http\S+(?=/ )", said)
        assert found, (said, (data.parent / f"{data.name}.log").read_text())
        yield found.group()
    finally:
        process.terminate()
        try:
            process.wait(120)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.stdout.close()
