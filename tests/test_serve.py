"""The launcher of web process and worker."""

import subprocess
from itertools import pairwise
from pathlib import Path

import pytest
from tests.running import serving

from treestroke.cli import main
from treestroke.serve import Child


def test_a_data_folder_is_one_launcher_s(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with serving(tmp_path / "data"):
        assert main(["serve", "--data", str(tmp_path / "data"), "--port", "0"]) == 2
        assert "another `treestroke serve` keeps its data there; stop it, or name another" in capsys.readouterr().err
    assert (tmp_path / "data").stat().st_mode & 0o077 == 0


def test_a_process_that_gives_up_at_once_is_started_ever_more_slowly(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    clock = [1000.0]
    monkeypatch.setattr("treestroke.serve.time.monotonic", lambda: clock[0])
    child = Child("no.such.module", {"PATH": ""})
    starts = []
    for _ in range(200):
        before = child._process
        child.look()
        if child._process is not None and child._process is not before:
            starts.append(clock[0])
            subprocess.Popen.wait(child._process)
        clock[0] += 0.1
    assert child._process is None or child._process.communicate() == (None, None)
    gaps = [round(later - earlier, 1) for earlier, later in pairwise(starts)]
    assert gaps == sorted(gaps)
    assert gaps[0] < 0.5 < 6 < gaps[-1]
    assert "started again" in capfd.readouterr().err
