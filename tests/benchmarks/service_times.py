"""What a person with a pen in hand waits for, measured on a running service; `make bench` prints it.

A photo of 1200 x 1541 px and three strokes, of which each request moves the last: no answer is a repeated one.
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from tests.running import serving

EXAMPLES = Path(__file__).parents[2] / "examples"
PHOTO, STROKES = EXAMPLES / "burr_oak_dusk.jpg", EXAMPLES / "burr_oak_dusk.strokes.json"
REQUESTS, WARM_UP, CLIENTS = 200, 5, 8


def moved(strokes: dict[str, Any], number: int) -> dict[str, Any]:
    """Keep three branch strokes and shift the last a little, elsewhere for every number."""
    last = strokes["branches"][2]["points"]
    shifted = [[x + number % 23 - 11, y + number % 17 - 8 + number / 1000] for x, y in last]
    return {"crown": strokes["crown"], "branches": [*strokes["branches"][:2], {"points": shifted}]}


def seconds(send: Callable[[], httpx.Response]) -> float:
    """Time one request that must succeed."""
    began = time.perf_counter()
    answer = send()
    took = time.perf_counter() - began
    assert answer.status_code in (200, 202), answer.text
    return took


def say(name: str, took: list[float]) -> None:
    """Write down the times of many requests."""
    middle, late, worst = np.percentile(took, [50, 95, 100])
    sys.stdout.write(f"{name:<46} n {len(took):4}   p50 {middle:6.3f}   p95 {late:6.3f}   max {worst:6.3f} s\n")


def traces(
    web: httpx.Client, photo: str, strokes: dict[str, Any], count: int, first: int = 0, **more: Any
) -> list[float]:
    """Trace a photo again and again."""
    bodies = [{**moved(strokes, first + number), **more} for number in range(count)]
    return [seconds(lambda body=body: web.post(f"/v1/photos/{photo}/trace", json=body)) for body in bodies]


def crowded(web: httpx.Client, photos: list[str], strokes: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Let eight clients trace while two models grow; give their times, and those of /livez meanwhile."""
    for seed in (1, 2):
        assert web.post("/v1/models", json={"photo": photos[0], "strokes": strokes, "seed": seed}).status_code == 202
    with ThreadPoolExecutor(CLIENTS) as clients:
        began = [clients.submit(traces, web, photo, strokes, 6, 100 * at) for at, photo in enumerate(photos)]
        lives = []
        while not all(one.done() for one in began):
            lives.append(seconds(lambda: web.get("/livez")))
            time.sleep(0.05)
        return [took for one in began for took in one.result()], lives


def main() -> None:
    """Print the times."""
    strokes = json.loads(STROKES.read_bytes())
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "data", workers=2) as address,
        httpx.Client(base_url=address, timeout=60) as web,
    ):
        photos = [web.post("/v1/photos", content=PHOTO.read_bytes()).json()["id"] for _ in range(CLIENTS)]
        crowns = []
        for shift in range(5):
            points = [[x + shift, y] for x, y in strokes["crown"]["points"]]
            crowns += traces(web, photos[0], {**strokes, "crown": {"points": points}}, 1)
        say("a new crown", crowns)
        traces(web, photos[0], strokes, WARM_UP)
        say("one more stroke", traces(web, photos[0], strokes, REQUESTS))
        say("one more stroke, the tree grown anew", traces(web, photos[0], strokes, 50, grow=True))
        busy, lives = crowded(web, photos, strokes)
        say("one more stroke, 8 clients beside 2 models", busy)
        say("/livez meanwhile", lives)


if __name__ == "__main__":
    sys.exit(main())
