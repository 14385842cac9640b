"""The README's examples of the service, run as they are written but for the port."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.running import BACKEND, serving

ROOT = Path(__file__).parents[2]
SERVICE = (ROOT / "README.md").read_text().split("\n## Service\n")[1].split("\n## ")[0]
WRITTEN = "http://127.0.0.1:8000"


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with serving(tmp_path_factory.mktemp("service") / "data") as address:
        yield address


def example(language: str, address: str) -> str:
    (block,) = re.findall(rf"^```{language}\n(.*?)^```$", SERVICE, re.M | re.S)
    assert WRITTEN in block
    return block.replace(WRITTEN, address)


def ran(command: list[str], place: Path) -> str:
    (place / "examples").symlink_to(ROOT / "examples")
    environment = {**os.environ, "PYTHONPATH": str(BACKEND)}
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert (place / "maple.glb").read_bytes()[:4] == b"glTF"
    return done.stdout


@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed")
def test_the_shell_example_runs(address: str, tmp_path: Path) -> None:
    assert ran(["sh", "-eu", "-c", example("sh", address)], tmp_path) == ""
    assert (tmp_path / "trace.json").read_text().startswith("{")


def test_the_python_example_runs(address: str, tmp_path: Path) -> None:
    said = ran([sys.executable, "-c", example("python", address)], tmp_path)
    assert "succeeded None 100%" in said
    assert "silhouette_iou" in said
    assert (tmp_path / "maple.png").read_bytes()[:4] == b"\x89PNG"
