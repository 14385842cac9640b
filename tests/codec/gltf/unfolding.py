"""Compressed buffer views read by a decoder that is not ours: the one that three.js ships, run by Node.js."""

import base64
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from treestroke.codec.gltf.meshopt import Bytes

ROOT = Path(__file__).parents[3]
MODULE = ROOT / "frontend/node_modules/three/examples/jsm/libs/meshopt_decoder.module.js"


def unfold(content: bytes, views: list[dict]) -> list[Bytes]:
    """Decode views, rows as glTF's extension has them, into their elements (n, s)."""
    if shutil.which("node") is None or not MODULE.is_file():
        assert os.environ.get("CI") != "true", "node or the page's packages are missing"
        pytest.skip("node or the page's packages are missing: run `make page`")
    rows = [{"byteOffset": 0, "filter": "NONE", **view} for view in views]
    asked = {"module": str(MODULE), "content": base64.b64encode(content).decode(), "views": rows}
    script = Path(__file__).parent / "official_decoder.mjs"
    run = subprocess.run(["node", str(script)], input=json.dumps(asked).encode(), capture_output=True, check=False)
    assert run.returncode == 0, run.stderr.decode()
    unfolded = [np.frombuffer(base64.b64decode(one), np.uint8) for one in json.loads(run.stdout)]
    return [one.reshape(-1, row["byteStride"]) for one, row in zip(unfolded, rows, strict=True)]


def unfold_one(content: bytes, count: int, stride: int, mode: str = "ATTRIBUTES", filter_: str = "NONE") -> Bytes:
    """Decode one stream."""
    view = {"byteLength": len(content), "count": count, "byteStride": stride, "mode": mode, "filter": filter_}
    return unfold(content, [view])[0]
