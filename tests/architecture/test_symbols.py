"""What the documents name in backticks exists: paths, modules, symbols, commands, flags, variables, routes."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from tests.architecture.names import (
    DOCUMENTS,
    PACKAGE,
    ROOT,
    exists,
    is_ours,
    modules,
    paths,
    routes,
    source_words,
    words_of,
)

from treestroke.settings import Settings

ALLOWED = {
    ".venv/bin/treestroke": "made by `make`",
    "out/": "made by `make run`",
    "photos/NAME.png": "members of project files",
    "out/e2e/": "made by `make test`",
    "api/page": "made by `make page`",
    "<Method>Params": "a pattern of names",
    "secrets/": "made by deploy/secrets.sh",
    "secrets/TREESTROKE_SECRET": "made by deploy/secrets.sh",
    "UPDATE": "SQL",
    "GaussianMixture": "scikit-learn's class, which 0005 decides against",
    "vertex_indices": "PLY's property, which trimesh writes",
    "leaf_03": "an example of a glTF node's name",
    "leaf_03_mirrored": "an example of a glTF node's name",
}
"""What is named though no source has it, and why."""
SOURCE_ENDINGS = ("py", "pyi", "c", "ts", "tsx", "md", "toml", "txt", "yml")
FENCED = re.compile(r"^```.*?^```", re.M | re.S)
TOKEN = re.compile(r"`([^`\n]+)`")
PATH = re.compile(rf"[\w.-]+(/[\w.-]+)+/?|[\w.-]+/|[\w-][\w.-]*\.(?:{'|'.join(SOURCE_ENDINGS)})")
MEDIA_TYPE = re.compile(r"(?:application|audio|image|model|text|multipart)/[\w.+*-]+")
PLACEHOLDER = re.compile(r"[A-Z]{2,}[._]\w*[a-z].*|/?STEM|NAME")
PRODUCT = re.compile(r"\w+(?:\.\w+)*\.(?:csv|glb|gltf|jpg|json|mtl|obj|ply|png|swc|usdc|usdz|zip)")
"""A file that treestroke reads or writes."""
OF_A_MACHINE = re.compile(r"/(?:etc|run|var)(?:/[\w.-]+)+")
"""A path on the machine of an operator."""
FOREIGN = (MEDIA_TYPE, PLACEHOLDER, PRODUCT, OF_A_MACHINE)
ROUTE = re.compile(r"(?:(GET|POST|PUT|PATCH|DELETE) )?(/[\w{}./-]*|\.\.\./[\w.]+)(?:\?[\w=&]*)?")
DOTTED = re.compile(r"(\w+)(?:\.\w+)+")
NAME = re.compile(r"_?[a-z]\w*_\w+|_[a-z]\w*|_?[A-Z][A-Z0-9_]{2,}|_?[A-Z]\w*[a-z]\w*")
"""A name with an underscore, a constant, a class: not a plain word, which may be anything."""


class Mention(NamedTuple):
    """A token in backticks, and the line of the document that it is on."""

    line: int
    token: str


def mentions(text: str) -> Iterator[Mention]:
    """Yield what a document names in backticks, without its fenced and indented blocks."""
    text = FENCED.sub(lambda block: "\n" * block.group().count("\n"), text)
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.startswith("    "):
            yield from (Mention(number, token) for token in TOKEN.findall(line))


def is_missing(token: str) -> bool:
    """Tell whether a token names something of the project that is not there."""
    if token in ALLOWED or token in source_words() or any(form.fullmatch(token) for form in FOREIGN):
        return False
    for form, known in _FORMS.items():
        if found := re.fullmatch(form, token):
            return not known(found)
    if route := ROUTE.fullmatch(token):
        return not _is_route(route)
    if PATH.fullmatch(token):
        return not _is_path(token.rstrip("/"))
    called = re.sub(r"\(.*\)$", "", token)
    if dotted := DOTTED.fullmatch(called):
        return is_ours(dotted[1]) and not exists(called)
    return bool(NAME.fullmatch(called)) and called not in source_words() and called not in _module_names()


def _is_make_target(found: re.Match[str]) -> bool:
    makefile = (ROOT / "Makefile").read_text()
    target = found[1] is None or re.search(rf"^{found[1]}:", makefile, re.M)
    return bool(target) and (found[2] is None or bool(re.search(rf"^{found[2]} \?=", makefile, re.M)))


def _is_variable(found: re.Match[str]) -> bool:
    return found[1].lower() in Settings.model_fields or f"TREESTROKE_{found[1]}" in source_words()


def _is_flag(found: re.Match[str]) -> bool:
    name = found[1].removeprefix("--").removeprefix("no-").replace("-", "_")
    return found[1] in source_words() or name in source_words()


def _is_command(found: re.Match[str]) -> bool:
    return found[1] in words_of(PACKAGE / "cli.py")


def _is_script(found: re.Match[str]) -> bool:
    return f'"{found[1]}":' in (ROOT / "frontend" / "package.json").read_text()


_FORMS = {
    r"make(?: ([a-z]+))?(?: ([A-Z]+)=\S+)?": _is_make_target,
    r"(?:make )?()?([A-Z]+)=[\w]+": lambda found: bool(
        re.search(rf"^{found[2]} \?=", (ROOT / "Makefile").read_text(), re.M)
    ),
    r"TREESTROKE_(\w+)": _is_variable,
    r"treestroke_(\w+)": lambda found: found[1] in source_words(),
    r"(--[a-z_-]+)(?: [\w.,]+)?": _is_flag,
    r"treestroke ([a-z]+)": _is_command,
    r"npm run (\w+)": _is_script,
}


def _is_route(found: re.Match[str]) -> bool:
    """Tell whether a method and an address, or the end of an address, are those of a route."""
    method, path = found[1] or "", found[2].removeprefix("...")
    pattern = re.compile(rf"{method or '[A-Z]+'} {'.*' if found[2] != path else ''}{re.escape(path)}")
    return any(pattern.fullmatch(route) or _matches(route, method, path) for route in routes())


def _matches(route: str, method: str, path: str) -> bool:
    """Tell whether a route with parameters takes an address such as /v1/models/{id}/tree.glb."""
    parts = [re.escape(part) for part in re.split(r"\{\w+\}", route)]
    return route.startswith(method) and re.fullmatch("[^/]+".join(parts), f"{route.split()[0]} {path}") is not None


def _is_path(token: str) -> bool:
    """Tell whether a path is there: whole, the end of one, or one without its ending."""
    return any(path == token or path.endswith(f"/{token}") or path.startswith(f"{token}.") for path in paths())


@cache
def _module_names() -> frozenset[str]:
    return frozenset(part for name in modules() for part in name.split("."))


def test_each_exception_is_still_named_and_still_needed() -> None:
    named = {token for document in DOCUMENTS for _, token in mentions((ROOT / document).read_text())}
    assert set(ALLOWED) - named == set()
    assert set(ALLOWED) & source_words() == set()


def test_the_architecture_names_every_module_of_the_package_and_every_part_of_the_core() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text()
    names = {name.removeprefix("core.") for name in modules() if re.fullmatch(r"(core\.)?[a-z_]+", name)}
    assert [name for name in sorted(names) if not re.search(rf"\b{name}\b", text)] == []


@pytest.mark.parametrize("document", DOCUMENTS)
def test_what_a_document_names_exists(document: str) -> None:
    named = mentions((ROOT / document).read_text())
    assert [f"line {line}: {token}" for line, token in named if is_missing(token)] == []


def _rows() -> Iterator[tuple[int, list[Path], list[str]]]:
    """Yield the rows of docs/papers.md that say which symbols a file has: line, files, symbols."""
    for number, line in enumerate((ROOT / "docs" / "papers.md").read_text().splitlines(), start=1):
        cells = line.split(" | ")
        if line.startswith("| ") and len(cells) == 4:
            files = [PACKAGE / "core" / name for name in TOKEN.findall(cells[1])]
            yield number, [file for file in files if file.is_file()], TOKEN.findall(cells[2])


def test_each_symbol_of_a_paper_is_in_the_files_beside_it() -> None:
    gone = [
        f"line {number}: {symbol}"
        for number, files, symbols in _rows()
        for symbol in symbols
        if files and not any(set(re.findall(r"\w+", symbol)) <= words_of(file) for file in files)
    ]
    assert gone == []


@pytest.mark.parametrize(
    "token",
    [
        "core/pipeline/nowhere.py",
        "core.geometry.Lens",
        "Mesh.grip",
        "MOST_ANTLERS",
        "_untwisted",
        "with_roots",
        "BarkParams2",
    ],
)
def test_a_name_that_is_gone_is_found(token: str) -> None:
    assert is_missing(token)


@pytest.mark.parametrize(
    "token",
    ["make nothing", "treestroke dance", "--loudness", "TREESTROKE_NOTHING", "GET /v1/forests", "npm run nothing"],
)
def test_a_command_that_is_gone_is_found(token: str) -> None:
    assert is_missing(token)


@pytest.mark.parametrize(
    "token",
    ["store.leases", "core/skeleton/skeleton.py", "Skeleton", "make test", "treestroke serve", "--leaf-size", "height"],
)
def test_a_name_that_is_there_is_none_of_them(token: str) -> None:
    assert not is_missing(token)
