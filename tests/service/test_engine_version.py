import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.running import BACKEND

from treestroke import __version__
from treestroke.service.engine_version import LIBRARIES, digest, engine_version, sources

PACKAGE = BACKEND / "treestroke"
ROOT = BACKEND.parent


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """The package's sources in another place."""
    place = tmp_path / "elsewhere" / "treestroke"
    shutil.copytree(PACKAGE, place, ignore=shutil.ignore_patterns("page", "*.so", "__pycache__"))
    return place


def test_the_engine_is_named_by_version_and_digest_wherever_it_lies(copied: Path) -> None:
    assert engine_version() == f"treestroke {__version__}+{digest(copied, LIBRARIES)}"
    assert len(engine_version()) <= 40  # as the table has it


@pytest.mark.parametrize(
    "file", ["core/grow/form.py", "core/grow/_engine.c", "codec/gltf/book.py", "service/report.py", "core/leaf/new.txt"]
)
def test_another_byte_of_what_makes_the_tree_is_another_engine(copied: Path, file: str) -> None:
    before = digest(copied, LIBRARIES)
    with (copied / file).open("ab") as changed:
        changed.write(b" ")
    assert digest(copied, LIBRARIES) != before


def test_what_does_not_make_the_tree_is_the_same_engine(copied: Path) -> None:
    before = digest(copied, LIBRARIES)
    for file in ("api/middleware.py", "service/doctor.py", "core/grow/_engine.so", "core/__pycache__/a.pyc"):
        (copied / file).parent.mkdir(exist_ok=True)
        with (copied / file).open("ab") as changed:
            changed.write(b" ")
    assert digest(copied, LIBRARIES) == before


@pytest.mark.parametrize("library", LIBRARIES)
def test_another_version_of_a_library_is_another_engine(library: str) -> None:
    assert digest(PACKAGE, LIBRARIES) != digest(PACKAGE, {**LIBRARIES, library: "0"})


def test_every_module_that_makes_a_tree_counts() -> None:
    """Whatever is imported on the way from input to files is hashed, but for the package's own first file."""
    code = (
        "import sys, treestroke.service.model; "
        "print(*(m.__file__ for n, m in sys.modules.items() if n.startswith('treestroke')), sep='\\n')"
    )
    environment = {**os.environ, "PYTHONPATH": str(BACKEND)}
    told = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    imported = {Path(line) for line in told.stdout.splitlines() if line.endswith(".py")}
    others = {path.relative_to(PACKAGE).as_posix() for path in imported - set(sources(PACKAGE))}
    assert others == {"__init__.py", "service/__init__.py", "service/engine_version.py"}


def test_the_wheel_s_files_are_the_same_engine(copied: Path) -> None:
    build = copied.parents[1]
    shutil.move(copied, build / "backend" / "treestroke")
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, build)
    command = [sys.executable, "setup.py", "-q", "build_py", "--build-lib", "lib"]
    subprocess.run(command, cwd=build, check=True, capture_output=True)
    assert digest(build / "lib" / "treestroke", LIBRARIES) == digest(PACKAGE, LIBRARIES)
