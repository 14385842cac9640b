"""What event streams cost the web process, and what other calls wait for beside them; `make bench` prints it.

Two models grow, others queue behind them, and 25, 200 or 500 idle streams follow those that queue. Other calls are
lists and looks at one model.
"""

import json
import os
import socket
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import numpy as np
from tests.benchmarks.service_times import PHOTO, STROKES, say, seconds
from tests.running import serving

STREAMS, GROWING, QUEUED, REQUESTS = (0, 25, 200, 500), 2, 8, 100
MOST_SECONDS = 0.25
"""What 95 of 100 calls may take beside the most streams."""
LONG = {"iterations": 2000, "leaf_density": 3, "variants": 16}


def web_process(data: Path) -> Path:
    """Find the web process's folder below /proc."""
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command, environment = (folder / "cmdline").read_bytes(), (folder / "environ").read_bytes()
        except OSError:
            continue
        if b"treestroke.api" in command and f"TREESTROKE_DATA={data}\0".encode() in environment:
            return folder
    raise AssertionError("no web process")


def processor_seconds(process: Path) -> float:
    """Say how long a process has computed."""
    user, system = (process / "stat").read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


@contextmanager
def followed(address: str, models: list[str], count: int) -> Iterator[None]:
    """Hold streams open, each of which has begun."""
    at = urlsplit(address)
    with ExitStack() as streams:
        for number in range(count):
            line = streams.enter_context(socket.create_connection((at.hostname, at.port), timeout=60))
            asked = f"GET /v1/models/{models[number % len(models)]}/events HTTP/1.1\r\nHost: {at.netloc}\r\n\r\n"
            line.sendall(asked.encode())
            assert line.recv(12) == b"HTTP/1.1 200"
        yield


def main() -> None:
    """Print the times, and fail where the most streams make others wait."""
    strokes = json.loads(STROKES.read_bytes())
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "data", model_seconds=3600, workers=GROWING) as address,
        httpx.Client(base_url=address, timeout=60) as web,
    ):
        photo = web.post("/v1/photos", content=PHOTO.read_bytes()).json()["id"]
        models = []
        for seed in range(GROWING + QUEUED):
            asked = {"photo": photo, "strokes": strokes, "seed": seed, "settings": LONG}
            models.append(web.post("/v1/models", json=asked).json()["id"])
        process = web_process(Path(folder) / "data")
        for count in STREAMS:
            with followed(address, models[GROWING:], count):
                time.sleep(2)
                computed, began = processor_seconds(process), time.monotonic()
                time.sleep(5)
                cores = (processor_seconds(process) - computed) / (time.monotonic() - began)
                took = {
                    "GET /v1/models": [seconds(lambda: web.get("/v1/models")) for _ in range(REQUESTS)],
                    "GET /v1/models/{id}": [
                        seconds(lambda: web.get(f"/v1/models/{models[0]}")) for _ in range(REQUESTS)
                    ],
                }
            for call, times in took.items():
                say(f"{call}, {count} streams ({cores:.2f} cores)", times)
        for model in models:
            web.post(f"/v1/models/{model}/cancel")
    assert all(np.percentile(times, 95) < MOST_SECONDS for times in took.values())


if __name__ == "__main__":
    sys.exit(main())
