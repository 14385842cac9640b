"""The units of systemd in deploy/systemd, as far as they can be judged without systemd as the first process."""

import shutil
import subprocess
from pathlib import Path

import pytest

from treestroke.serve import STOP_SECONDS
from treestroke.settings import Settings

FOLDER = Path(__file__).parents[1] / "deploy" / "systemd"
PROGRAM = "/usr/local/lib/treestroke/bin/treestroke"
COMMANDS = {"treestroke-web": "serve", "treestroke-worker": "worker"}


def entries(name: str) -> dict[str, str]:
    """Return what a unit says of its service."""
    text = (FOLDER / f"{name}.service").read_text().split("[Service]\n")[1].split("\n[")[0]
    return dict(line.split("=", 1) for line in text.splitlines() if "=" in line and not line.startswith("#"))


@pytest.mark.parametrize("name", COMMANDS)
def test_a_unit_starts_its_process_and_lets_it_stop(name: str) -> None:
    said = entries(name)
    assert said["ExecStart"] == f"{PROGRAM} {COMMANDS[name]}"
    assert (said["Restart"], said["KillMode"]) == ("always", "mixed")
    assert int(said["TimeoutStopSec"]) > STOP_SECONDS
    given = {pair.split("=")[0] for pair in said["Environment"].split()}
    assert given <= {f"TREESTROKE_{field.upper()}" for field in Settings.model_fields}


def test_both_units_are_bounded_alike() -> None:
    web, worker = (entries(name) for name in COMMANDS)
    differ = {key for key in {*web, *worker} if web.get(key) != worker.get(key)}
    assert differ == {"ExecStart", "Environment", "MemoryMax", "TasksMax"}
    assert (web["ProtectSystem"], web["NoNewPrivileges"], web["CapabilityBoundingSet"]) == ("strict", "yes", "")
    assert (web["StateDirectory"], web["StateDirectoryMode"]) == ("treestroke", "0700")


def test_systemd_takes_the_units(tmp_path: Path) -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd is not installed")
    for name in COMMANDS:
        text = (FOLDER / f"{name}.service").read_text()
        (tmp_path / f"{name}.service").write_text(text.replace(PROGRAM, "/bin/true"))
    units = sorted(map(str, tmp_path.iterdir()))
    done = subprocess.run(["systemd-analyze", "verify", *units], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
