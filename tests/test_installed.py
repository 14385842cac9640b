"""treestroke as an image holds it: a wheel in an environment of requirements.txt alone, away from its source."""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from tests.api import drawn, sketched
from tests.faults.processes import wait_for
from tests.faults.redis_server import RedisServer, need_redis

ROOT = Path(__file__).parents[1]
PATIENCE_SECONDS = 600
"""Emergency exit of what is waited for."""
BUILT_OF = ("pyproject.toml", "setup.py", "README.md", "LICENSE", "backend")
"""What the Dockerfile copies."""
FLAGS = [f"--{name.replace('_', '-')}={value}" for name, value in drawn.QUICK.items()]
IMPORT_ALL = """
import importlib, pkgutil, sys, treestroke
run_at_import = ("treestroke.__main__", "treestroke.api.__main__", "treestroke.store.migrations.env")
for module in pkgutil.walk_packages(treestroke.__path__, "treestroke."):
    if module.name not in run_at_import:
        importlib.import_module(module.name)
print(treestroke.__file__)
"""


@dataclass(frozen=True)
class Installed:
    """An environment with treestroke, the wheel it is from, and a folder to work in."""

    bin: Path
    wheel: Path
    folder: Path

    def start(self, *command: object, **settings: object) -> subprocess.Popen[str]:
        """Start one of the environment's commands in the folder, told nothing of the source."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "TREESTROKE_"))}
        given = {f"TREESTROKE_{name.upper()}": str(value) for name, value in settings.items()}
        words = [str(self.bin / str(command[0])), *map(str, command[1:])]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        return subprocess.Popen(words, text=True, cwd=self.folder, env={**kept, **given}, **pipes)

    def run(self, *command: object, **settings: object) -> str:
        """Run a command that must succeed; give what it says."""
        process = self.start(*command, **settings)
        said, complained = process.communicate(timeout=PATIENCE_SECONDS)
        assert process.returncode == 0, said + complained
        return said


def pip(*arguments: object) -> None:
    command = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", *map(str, arguments)]
    subprocess.run(command, check=True)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """Takes over 20 s: pip makes an environment of requirements.txt alone."""
    place = tmp_path_factory.mktemp("installed")
    source, environment, folder = (place / name for name in ("source", "environment", "folder"))
    for path in (source, folder):
        path.mkdir()
    unbuilt = shutil.ignore_patterns("*.so", "*.egg-info", "__pycache__")
    for name in BUILT_OF:
        given, taken = ROOT / name, source / name
        shutil.copytree(given, taken, ignore=unbuilt) if given.is_dir() else shutil.copy(given, taken)
    pip("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", place, source)
    (wheel,) = place.glob("*.whl")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    install = ("--python", environment / "bin" / "python", "install", "--no-compile")
    pip(*install, "--require-hashes", "-r", ROOT / "requirements.txt")
    pip(*install, "--no-deps", wheel)
    drawn_files = {"tree.png": drawn.encoded(), "strokes.json": json.dumps(drawn.STROKES).encode()}
    drawn_files |= {"front.json": json.dumps(sketched.FRONT).encode(), "side.json": json.dumps(sketched.SIDE).encode()}
    for name, content in drawn_files.items():
        (folder / name).write_bytes(content)
    return Installed(environment / "bin", wheel, folder)


def test_the_wheel_holds_the_whole_package_and_its_compiled_parts(installed: Installed) -> None:
    package = ROOT / "backend" / "treestroke"
    files = {path for path in package.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    wanted = {f"treestroke/{path.relative_to(package)}" for path in files if path.suffix not in (".so", ".c")}
    with zipfile.ZipFile(installed.wheel) as wheel:
        names = {name for name in wheel.namelist() if ".dist-info/" not in name and not name.endswith(".c")}
        page = wheel.read("treestroke/api/page/index.html").decode()
    compiled = {name for name in names if re.fullmatch(r"treestroke/core/(grow/_engine|leaf/_covering)\..*\.so", name)}
    assert len(compiled) == (2 if shutil.which("cc") else 0)
    assert names - compiled == {name for name in wanted if "/page/.built-" not in name}
    assert {"treestroke/py.typed", "treestroke/store/migrations/script.py.mako"} <= names
    named = set(re.findall(r'(?:src|href)="/page/([^"]+)"', page))
    assert named
    assert {f"treestroke/api/page/{asset}" for asset in named} <= names


def test_every_module_is_imported(installed: Installed) -> None:
    assert installed.run("python", "-c", IMPORT_ALL).startswith(str(installed.bin.parent))


def test_the_commands_that_make_something_run(installed: Installed) -> None:
    assert re.fullmatch(r"treestroke \d+\.\d+\.\d+\n", installed.run("treestroke", "--version"))
    assert json.loads(installed.run("treestroke", "trace", "tree.png", "--strokes", "strokes.json"))["skeleton"]
    made = {
        "model": ["tree.png", "--strokes", "strokes.json"],
        "sketch": ["front.json", "side.json"],
    }
    for command, given in made.items():
        installed.run("treestroke", command, *given, *FLAGS, "--out", f"{command}.glb", "--preview", f"{command}.png")
        assert (installed.folder / f"{command}.glb").read_bytes()[:4] == b"glTF"
        assert (installed.folder / f"{command}.png").read_bytes()[:4] == b"\x89PNG"


@contextmanager
def ended(process: subprocess.Popen[str]) -> Iterator[subprocess.Popen[str]]:
    """Tell a process to stop when it is no longer needed; what it said goes where nobody reads it."""
    try:
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE_SECONDS)


def well(installed: Installed, **settings: object) -> str:
    """Return what the doctor says where it finds all well; a worker of a busy machine may beat later than it looks."""
    doctor = installed.start("treestroke", "doctor", **settings)
    said, _ = doctor.communicate(timeout=PATIENCE_SECONDS)
    return said if doctor.returncode == 0 else ""


@pytest.fixture
def redis(tmp_path: Path) -> Iterator[RedisServer]:
    need_redis()
    server = RedisServer(tmp_path / "redis")
    yield server
    server.kill()


def test_a_model_grows_through_a_redis_and_the_doctor_finds_all_well(installed: Installed, redis: RedisServer) -> None:
    """May take over 20 s on a busy machine: a service, a worker, a Redis and the doctor are started."""
    settings = {"data": installed.folder / "data", "broker_url": redis.url, "tracers": 1}
    serve = ("treestroke", "serve", "--port", "0")
    with (
        ended(installed.start(*serve, **settings, workers=0)) as web,
        ended(installed.start("treestroke", "worker", **settings)),
    ):
        assert web.stdout is not None
        address = re.search(r"http\S+(?=/ )", web.stdout.readline())
        assert address
        with httpx.Client(base_url=address.group(), timeout=PATIENCE_SECONDS) as client:
            assert '<script type="module"' in client.get("/").text
            place = client.post("/v1/models", **drawn.form(drawn.encoded())).headers["location"]
            wait_for(lambda: client.get(place).json()["finished"], PATIENCE_SECONDS, "the model", 0.1)
            grown = client.get(place).json()
            assert grown["status"] == "succeeded", grown
            tree = client.get(grown["files"]["tree.glb"]).content
            port = client.base_url.port
        said = wait_for(
            lambda: well(installed, **settings, port=port), PATIENCE_SECONDS, "a doctor that finds all well"
        )
    found = dict(re.findall(r"^ok   (\S+(?: \S+)?) +(\S.*)$", said, re.M))
    assert found["web process"] == f"responds at 127.0.0.1:{port}"
    assert found["queue"] == "Redis accepts messages"
    assert found["workers"] == "1 of 1 are running"
    assert "ILL" not in said
    installed.run("treestroke", "model", "tree.png", "--strokes", "strokes.json", *FLAGS, "--out", "same.glb")
    assert (installed.folder / "same.glb").read_bytes() == tree
