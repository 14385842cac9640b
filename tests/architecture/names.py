"""The names that the sources define or use: what the documents may name."""

import ast
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import treestroke
from treestroke.api.app import make_app
from treestroke.settings import Settings

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "backend" / "treestroke"
DOCUMENTS = [
    *("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"),
    *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")),
]
_BUILT = {"node_modules", "__pycache__", ".git", "out", "dist"}
_WORD = re.compile(r"[A-Za-z_]\w*")
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
_LINE_OF_COMMENT = re.compile(r"^\s*#.*$", re.M)


@cache
def paths() -> frozenset[str]:
    """Return all files and folders of the project, relative to its root, without what is built or installed."""
    found = set()
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders if name not in _BUILT and not name.startswith(".venv")]
        found |= {(Path(folder) / name).relative_to(ROOT).as_posix() for name in (*folders, *files)}
    return frozenset(found)


@cache
def source_words() -> frozenset[str]:
    """Return the identifiers and the strings of all sources, without comments and docstrings."""
    python = {word for path in _python_files() for word in words_of(path)}
    return frozenset(python | {word for path in _other_files() for word in _WORD.findall(_without_comments(path))})


@cache
def words_of(path: Path) -> frozenset[str]:
    """Return the identifiers of one source, its strings as wholes, and the words with underscores in them."""
    if path.suffix != ".py":
        return frozenset(_WORD.findall(_without_comments(path)))
    tree = ast.parse(path.read_text())
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return frozenset(word for node in ast.walk(tree) if id(node) not in docstrings for word in _words(node))


@cache
def modules() -> dict[str, Path]:
    """Return the package's modules and packages by their dotted names below ``treestroke``."""
    found = {}
    for path in (*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.pyi")):
        inner = path.parent if path.stem == "__init__" else path.with_suffix("")
        found[inner.relative_to(PACKAGE).as_posix().replace("/", ".")] = path
    return found


@cache
def members() -> dict[str, frozenset[str]]:
    """Return what each class of the package has, inherited from classes of its own included, by the class's name."""
    classes = [node for path in PACKAGE.rglob("*.py") for node in ast.walk(ast.parse(path.read_text()))]
    named = [node for node in classes if isinstance(node, ast.ClassDef)]
    own = {node.name: frozenset(_members(node)) for node in named}
    bases = {node.name: [ast.unparse(base).rpartition(".")[2] for base in node.bases] for node in named}
    return {name: own[name].union(*(own.get(base, frozenset()) for base in bases[name])) for name in own}


@cache
def routes() -> frozenset[str]:
    """Return "METHOD /path" of every route, those that the API's document leaves out included."""
    described = make_app(Settings()).openapi()["paths"]
    named = {f"{method.upper()} {path}" for path, methods in described.items() for method in methods}
    return frozenset(named | {"GET /metrics", "GET /openapi.json", "GET /"})


def exists(dotted: str) -> bool:
    """Tell whether a dotted name, such as ``core.geometry.Camera`` or ``Mesh.hold``, is one of the package's."""
    parts = dotted.removeprefix("treestroke.").split(".")
    if dotted.startswith("treestroke.") and parts[0] in treestroke.__all__ and len(parts) == 1:
        return True
    if parts[0] in members():
        return len(parts) == 1 or (len(parts) == 2 and parts[1] in members()[parts[0]])
    return any(_in_module(path, parts[at:]) for at in range(len(parts), 0, -1) for path in _modules_called(parts[:at]))


def is_ours(head: str) -> bool:
    """Tell whether a dotted name that begins so can only be one of the package's."""
    return head == "treestroke" or head in members() or any(head in name.split(".") for name in modules())


def _modules_called(parts: list[str]) -> list[Path]:
    ending = ".".join(parts)
    return [path for name, path in modules().items() if name == ending or name.endswith(f".{ending}")]


def _in_module(path: Path, rest: list[str]) -> bool:
    if not rest:
        return True
    body = ast.parse(path.read_text()).body
    top = {word for node in body for word in _bound(node)}
    methods = {word for node in body if isinstance(node, ast.ClassDef) for word in members()[node.name]}
    if len(rest) == 1:  # a method may be named by its module alone: client.grow
        return rest[0] in top | methods
    return rest[0] in top and rest[1] in members().get(rest[0], ())


def _bound(node: ast.stmt) -> Iterator[str]:
    """Yield the names that a statement of a module binds."""
    match node:
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            yield name
        case ast.ImportFrom(names=names) | ast.Import(names=names):
            yield from (alias.asname or alias.name for alias in names)
        case ast.Assign() | ast.AnnAssign():
            yield from (part.id for part in ast.walk(node) if isinstance(part, ast.Name) and _stored(part))
        case ast.If(body=body):
            yield from (name for inner in body for name in _bound(inner))


def _members(node: ast.ClassDef) -> Iterator[str]:
    for inner in node.body:
        yield from _bound(inner)
    for part in ast.walk(node):
        if isinstance(part, ast.Attribute) and _stored(part) and ast.unparse(part.value) == "self":
            yield part.attr


def _stored(node: ast.Name | ast.Attribute) -> bool:
    return isinstance(node.ctx, ast.Store)


def _words(node: ast.AST) -> Iterator[str]:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.ClassDef(name=name):
            yield name
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
            yield name
        case ast.keyword(arg=str(name)):
            yield name
        case ast.Constant(value=str(text)):
            yield from (text, *(word for word in _WORD.findall(text) if "_" in word))
        case ast.alias(name=name, asname=other):
            yield from (*name.split("."), *((other,) if other else ()))


def _python_files() -> list[Path]:
    return [path for pattern in ("*.py", "*.pyi") for path in PACKAGE.rglob(pattern)]


def _other_files() -> list[Path]:
    page = ROOT / "frontend"
    return [
        *PACKAGE.rglob("*.c"),
        ROOT / "docker-compose.yml",
        *(path for path in (ROOT / "deploy").rglob("*") if path.is_file()),
        *page.glob("*.ts"),
        *(page / "src").rglob("*.ts"),
        *(page / "src").rglob("*.tsx"),
        page / "index.html",
    ]


def _without_comments(path: Path) -> str:
    comment = _COMMENT if path.suffix in (".c", ".ts", ".tsx", ".html") else _LINE_OF_COMMENT
    return comment.sub("", path.read_text())
