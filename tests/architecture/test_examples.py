"""The documents' examples, run as they are written but for the service's port: each page's one after another.

A shell reads the examples of the command line; this process then runs the commands, since each process of its own
would import treestroke again.
"""

import json
import re
import runpy
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from tests.architecture.documents import PAGES, cells, fences, named, rows, section, tables, text_of
from tests.architecture.names import ROOT
from tests.running import serving

from treestroke.cli import main

WRITTEN = "http://127.0.0.1:8000"
RECORDED = r"""treestroke() { printf '%s\0' "$@" >>commands.txt; echo >>commands.txt; }"""
BEGINNINGS = {"glb": b"glTF", "png": b"\x89PNG", "json": b"{", "treestroke": b"PK", "txt": b"event: snapshot"}
OUTPUT = re.compile(r"(?:--(?:out|report|preview|overlay)|-o) (\w\S*)")
PYTHON = {
    "README.md": (["silhouette_iou", "'basis': 'measured'"], ["tree.glb", "tree.swc"]),
    "docs/library.md": (["[["], ["vine.glb"]),
    "docs/http.md": (["joints are visible; {'silhouette_iou'", "succeeded None 100%"], ["maple.glb", "maple.png"]),
    "docs/webhooks.md": ([], []),
}
"""What a page's Python prints, and the files that it writes."""
Example = Callable[[str, str], str]


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = tmp_path_factory.mktemp("service") / "data"
    with serving(data, tracers=1, trace_seconds=600, model_seconds=3600) as address:  # however busy the machine is
        yield address


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder with the project's examples, to work in."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def example(place: Path, request: pytest.FixtureRequest) -> Example:
    """Return a page's examples in a language as one text, with the address of a running service if they need one."""

    def example(page: str, language: str) -> str:
        text = "\n".join(fence.text for fence in fences(page, language))
        return text.replace(WRITTEN, request.getfixturevalue("address")) if WRITTEN in text else text

    return example


def run_shell(text: str) -> None:
    """Run a shell's examples: their commands of treestroke in this process, all others in a shell."""
    done = subprocess.run(["sh", "-eu", "-c", f"{RECORDED}\n{text}"], capture_output=True, text=True, timeout=600)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    recorded = Path("commands.txt")
    for line in recorded.read_text().splitlines() if recorded.exists() else ():
        assert main(line.split("\0")[:-1]) == 0, line.replace("\0", " ")
    recorded.unlink(missing_ok=True)


def run_python(text: str) -> None:
    Path("example.py").write_text(text)
    runpy.run_path("example.py", run_name="__main__")


def check_files(place: Path) -> list[str]:
    """Return the names of the files that an example wrote, each of which begins as its ending says."""
    written = [path for path in sorted(place.iterdir()) if path.name not in ("examples", "example.py")]
    for path in written:
        ending = path.name.rpartition(".")[2]
        assert path.read_bytes().startswith(BEGINNINGS.get(ending, b"")), path.name
        assert path.stat().st_size > 0
    return [path.name for path in written]


@pytest.mark.parametrize("page", [page for page in PAGES if fences(page, "sh")])
def test_the_shell_examples_of_a_page_run(
    page: str, example: Example, place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = example(page, "sh")
    if "curl " in text and shutil.which("curl") is None:
        pytest.skip("curl is not installed")
    run_shell(text)
    assert capfd.readouterr() == ("", "")
    assert set(OUTPUT.findall(text)) <= set(check_files(place))


@pytest.mark.parametrize("page", PYTHON)
def test_the_python_examples_of_a_page_run(
    page: str, example: Example, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_python(example(page, "python"))
    printed, written = PYTHON[page]
    said = capsys.readouterr().out
    assert [words for words in printed if words not in said] == []
    assert check_files(place) == written


def test_every_page_with_python_is_known() -> None:
    assert set(PYTHON) == {page for page in PAGES if fences(page, "python")}


def test_the_documented_problem_is_what_the_service_answers(address: str) -> None:
    order, *_, problem = (json.loads(fence.text) for fence in fences("docs/http.md", "json"))
    del order["strokes"]["branches"]
    answer = httpx.post(f"{address}/v1/models", json=order, trust_env=False)
    assert answer.headers["Content-Type"] == "application/problem+json"
    said = answer.json()
    assert said.pop("request_id") == answer.headers["X-Request-Id"] != problem.pop("request_id")
    assert {**said, "title": problem["title"]} == problem  # the title is Python's name of the status


def test_a_report_has_the_keys_that_are_documented(place: Path) -> None:
    sketches = [f"examples/sketches/pear.{view}.json" for view in ("front", "side")]
    assert main(["sketch", *sketches, "--out", "pear.glb", "--report", "pear.json", "--iterations", "0"]) == 0
    report = json.loads(Path("pear.json").read_text())

    def documented(page: str, heading: str) -> set[str]:
        return {key for cell, *_ in rows(section(f"docs/{page}.md", heading)) for key in named(cell)}

    for_all, for_many = tables(text_of("docs/report.md").split("\n## ")[0])
    assert {named(cells(row)[0])[0] for row in for_all[2:]} == set(report)
    assert {named(cells(row)[0])[0] for row in for_many[2:]} == {"registered", "cameras", "photos"}
    assert documented("report", "Measures") == set(report["measures"])
    assert documented("report", "Reading") == set(report["reading"])
    of_sketches = documented("sketches", "How well the tree fits")
    assert set(report["score"]) == of_sketches | documented("report", "Score") - {"attractors_reached"}
