"""What the documents list is all that there is, and no more: settings, variables, flags, calls, codes, targets."""

import ast
import json
import re
from dataclasses import fields
from inspect import signature

import pytest
from tests.architecture.documents import FENCE, PAGES, cells, fences, named, rows, section, tables, text_of
from tests.architecture.names import PACKAGE, ROOT, routes

import treestroke
from treestroke.api.errors import _STATUS
from treestroke.capture_schemas import CaptureInfo
from treestroke.cli import main
from treestroke.client import Client
from treestroke.clip_schemas import ClipInfo
from treestroke.core.pipeline.settings import Choice, ModelSettings, Several
from treestroke.schemas import ModelInfo, PhotoInfo, Problem
from treestroke.service.failures import _DETAILS, problem_of_input
from treestroke.settings import PREFIX, Settings
from treestroke.wire_requests import CaptureTraceRequest, ModelRequest
from treestroke.wire_strokes import CaptureStrokes, FrameStrokes, Strokes, StrokeSketch

COMMANDS = (
    "model",
    "views",
    "video",
    "sketch",
    "siblings",
    "trace",
    "serve",
    "worker",
    "doctor",
    "keys",
    "backup",
    "restore",
    "migrate",
)
INVOCATION = re.compile(r"^(?:\$ )?treestroke (\w+)(.*)$", re.M)


def flags_of(command: str, capsys: pytest.CaptureFixture[str]) -> set[str]:
    """Return the flags that a command's help lists, with dashes."""
    with pytest.raises(SystemExit):
        main([command, "--help"])
    return {flag.replace("_", "-") for flag in re.findall(r"(?<!\S)--[a-z_-]+", capsys.readouterr().out)}


def test_the_settings_are_the_table() -> None:
    lists = {"form": "Form", "species": "Species", "foliage": "Foliage", "files": "More files"}
    found = [(*named(name), *rest) for name, *rest in rows(text_of("docs/settings.md").split("\n## ")[0])]
    plain = {"False": "false", "()": "none"}
    table = [
        (
            f.name,
            f"{f.default:g}" if isinstance(f.default, float) else plain.get(str(f.default), str(f.default)),
            f"[names](#{lists[f.name].lower().replace(' ', '-')})" if f.name in lists else str(f.metadata["allowed"]),
            f.metadata["meaning"],
        )
        for f in fields(ModelSettings)
    ]
    assert found == table


@pytest.mark.parametrize(
    ("name", "heading"), [("form", "Form"), ("species", "Species"), ("foliage", "Foliage"), ("files", "More files")]
)
def test_a_setting_s_long_list_of_names_is_complete(name: str, heading: str) -> None:
    (allowed,) = (f.metadata["allowed"] for f in fields(ModelSettings) if f.name == name)
    assert isinstance(allowed, Choice | Several)
    (listed,) = (named(part) for part in section("docs/settings.md", heading).split("\n\n") if part.startswith("`"))
    assert tuple(listed)[: len(allowed.names)] == allowed.names


def test_the_variables_are_the_service_s_settings() -> None:
    found = [(*named(name), *rest) for name, *rest in rows(section("docs/hosting.md", "Variables"))]
    table = [
        (f"{PREFIX}{name.upper()}", str(field.default) or "empty", field.description)
        for name, field in Settings.model_fields.items()
    ]
    assert found == table


def test_the_commands_are_those_of_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    listed = re.findall(r"^    (\w+) ", capsys.readouterr().out, re.M)
    table = rows(text_of("docs/cli.md").split("\n## ")[0])
    assert [named(name)[0] for name, _ in table] == [f"treestroke {name}" for name in listed]
    assert tuple(listed) == COMMANDS


@pytest.mark.parametrize("command", COMMANDS)
def test_the_flags_of_a_command_are_those_of_its_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    written = {
        named(flag)[0].split()[0]
        for flag, of, _ in rows(section("docs/cli.md", "Flags"))
        if of == "all" or command in of.split(", ")
    }
    if command in ("model", "views", "video", "sketch", "siblings"):
        assert f"`{command}`" in section("docs/cli.md", "Flags")
        flags = [f"--{f.name.replace('_', '-')}" for f in fields(ModelSettings)]
        written |= {*flags, "--no-compress", "--no-grove"}
    if command == "siblings":
        written -= {"--variants", "--siblings", "--grove", "--no-grove"}
    assert written == flags_of(command, capsys)


@pytest.mark.parametrize("name", PAGES)
def test_every_command_that_a_document_shows_has_the_flags_that_it_is_given(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shown = "\n".join(fence.text.replace("\\\n", " ") for fence in fences(name) if fence.language != "python")
    for command, rest in INVOCATION.findall(shown):
        assert command in COMMANDS
        assert set(re.findall(r"(?<!\S)\[?(--[a-z-]+)", rest)) <= flags_of(command, capsys)


@pytest.mark.parametrize("name", PAGES)
def test_every_make_target_that_a_document_shows_exists(name: str) -> None:
    makefile = (ROOT / "Makefile").read_text()
    shown = re.findall(r"^make ([a-z]+)", "\n".join(fence.text for fence in fences(name)), re.M)
    assert [target for target in shown if not re.search(rf"^{target}:", makefile, re.M)] == []


def test_every_make_target_is_documented() -> None:
    targets = re.findall(r"^([a-z]+): \$\(STAMP\)", (ROOT / "Makefile").read_text(), re.M)
    table = [named(name)[0] for name, _ in rows(section("CONTRIBUTING.md", "Commands"))]
    assert [t for t in targets if t != "setup" and f"make {t}" not in table] == []


@pytest.mark.parametrize("name", PAGES)
def test_every_variable_that_an_example_sets_exists(name: str) -> None:
    shown = "\n".join(text for _, text in FENCE.findall(text_of(name)))
    assert {v.lower() for v in re.findall(rf"{PREFIX}(\w+)", shown)} <= set(Settings.model_fields)


def test_the_calls_are_the_service_s_routes() -> None:
    tokens = [token for row in rows(text_of("docs/http.md")) for token in named(row[0])]
    calls = [token for token in tokens if re.match(r"[A-Z]+ /", token)]
    assert len(calls) == len(set(calls))
    assert set(calls) == routes()


@pytest.mark.parametrize(
    ("heading", "kind"), [("Photos", PhotoInfo), ("Models", ModelInfo), ("Captures", CaptureInfo), ("Clips", ClipInfo)]
)
def test_the_fields_of_an_answer_are_those_of_its_schema(
    heading: str, kind: type[PhotoInfo | ModelInfo | CaptureInfo | ClipInfo]
) -> None:
    (table,) = (t for t in tables(section("docs/http.md", heading)) if t[0].startswith("| field"))
    assert sorted(name for row in table[2:] for name in named(cells(row)[0])) == sorted(kind.model_fields)


def test_the_library_s_arguments_are_documented() -> None:
    page = text_of("docs/library.md")
    arguments = {
        name
        for function in (treestroke.model, treestroke.model_views, treestroke.model_video, treestroke.sketch)
        for name in signature(function).parameters
    }
    calls = {
        name
        for call in re.findall(r"`treestroke\.(?:model|model_views|model_video|sketch)\((.*?)\)`", page)
        for name in call.split(", ")
    }
    (table,) = (t for t in tables(page) if t[0].startswith("| argument"))
    assert calls | {name for row in table[2:] for name in named(cells(row)[0])} == arguments


def test_the_client_s_methods_are_documented() -> None:
    methods = {name for name in dir(Client) if not name.startswith("_")} - {"close"}
    with_python = text_of("docs/http.md").split("## With Python\n")[1].split("\n## ")[0]
    shown = set(re.findall(r"`(?:client\.)?([a-z_]+)(?:\(.*?\))?`|client\.([a-z_]+)\(", with_python))
    assert {name for pair in shown for name in pair if name} == methods


def test_the_codes_of_problems_are_those_of_the_service() -> None:
    table = {named(code)[0]: int(status) for code, status, _ in rows(section("docs/http.md", "Errors"))}
    assert table == _STATUS


def test_the_codes_of_failures_are_those_of_the_service() -> None:
    unusable = problem_of_input(treestroke.TreestrokeError("what is wrong"))["code"]
    table = {named(code)[0] for code, _ in rows(section("docs/http.md", "Why a model failed"))}
    assert table == {unusable, *(_DETAILS.keys() - _STATUS.keys())}


def test_the_warnings_are_those_of_the_sources() -> None:
    words = {
        node.value
        for place in ("core", "engines")
        for path in (PACKAGE / place).rglob("*.py")
        for call in ast.walk(ast.parse(path.read_text()))
        if isinstance(call, ast.Call) and ast.unparse(call.func) in ("StrokeWarning", "_warning")
        for node in call.args[:2]
        if isinstance(node, ast.Constant)
    }
    codes = {word for word in words if re.fullmatch(r"[a-z]+_[a-z_]+", word)}
    table = {named(code)[0] for code, _ in rows(section("docs/report.md", "Warnings"))}
    assert table == codes | {"photo_cut_short"}


def test_the_doctor_s_parts_are_those_that_it_examines() -> None:
    findings = (PACKAGE / "service" / "doctor.py").read_text()
    examined = set(re.findall(r"Finding\(\s*\"([a-z ]+)\"", findings))
    (shown,) = (fence.text for fence in fences("docs/hosting.md", "text"))
    assert set(re.findall(r"^(?:ok |ILL)  ([a-z ]+?)  ", shown, re.M)) == examined


def test_examples_in_json_are_what_the_service_takes_and_gives() -> None:
    (strokes,), (sketch,), (views,), (drawn,), (request, traced, captured, filmed, problem) = (
        [json.loads(fence.text) for fence in fences(f"docs/{name}.md", "json")]
        for name in ("formats", "sketches", "views", "video", "http")
    )
    assert set(strokes) == set(Strokes.model_fields)
    Strokes.model_validate(strokes)
    StrokeSketch.model_validate(sketch)
    CaptureStrokes.model_validate(views)
    ModelRequest.model_validate(request)
    CaptureTraceRequest.model_validate(traced)
    ModelRequest.model_validate(captured)
    ModelRequest.model_validate(filmed)
    FrameStrokes.model_validate(drawn)
    assert set(problem) == set(Problem.model_fields)
    Problem.model_validate(problem)


def test_every_example_has_strokes_and_a_source() -> None:
    photos = sorted((ROOT / "examples").glob("*.jpg"))
    sources = (ROOT / "examples" / "SOURCES.md").read_text()
    assert photos
    for photo in photos:
        assert json.loads(photo.with_suffix(".strokes.json").read_text())["branches"]
        assert f"| {photo.name} |" in sources


def test_every_test_photo_has_a_source() -> None:
    sources = (ROOT / "tests" / "data" / "SOURCES.md").read_text()
    photos = [p.name for p in (ROOT / "tests" / "data").glob("*.jpg")]
    assert [name for name in photos if f"| {name} |" not in sources] == []


def test_every_public_name_can_be_had() -> None:
    assert all(getattr(treestroke, name) is not None for name in treestroke.__all__)
