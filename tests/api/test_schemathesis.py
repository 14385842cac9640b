"""The live service against its own document: examples, boundary values, made-up requests, and chains of them."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.api import drawn
from tests.api.conftest import Service, running
from tests.api.corpora import saved
from tests.running import BACKEND

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service of its own; what it is asked to grow may be the largest of trees."""
    yield from running(tmp_path_factory.mktemp("tried"), model_seconds=4)


FEW = ["--phases", "examples,fuzzing,stateful", "--max-examples", "2"]


@pytest.mark.parametrize("less", [FEW, pytest.param([], marks=pytest.mark.nightly)], ids=["few", "all"])
def test_nothing_contradicts_the_document(tried: Service, tmp_path: Path, less: list[str]) -> None:
    """Takes over 20 s where all is tried: 65 operations, with every boundary value of their parameters."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(BACKEND), str(HERE.parents[1])]),
        "STORED_PHOTO": tried.add_photo(saved(drawn.picture_of_the_example(), "JPEG")),
    }
    program = Path(sys.executable).with_name("schemathesis")
    options = ["--config-file", HERE / "schemathesis.toml", "run", f"{tried.url}/openapi.json"]
    options += less
    ran = subprocess.run(
        [program, *options], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=1200
    )
    assert ran.returncode == 0, ran.stdout[-20_000:] + ran.stderr
    assert "Tested: 85" in ran.stdout
    log = (tried.data.parent / "data.log").read_text()
    assert "request_failed" not in log
    assert "Traceback" not in log
