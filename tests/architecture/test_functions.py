"""How large functions and files may be, what public array functions say of their arrays, and that no imports circle."""

import ast
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

import pytest
from tests.architecture.names import PACKAGE, modules

Function = ast.FunctionDef | ast.AsyncFunctionDef
MOST_ARGUMENTS, MOST_LINES, MOST_FILE_LINES = 5, 50, 400
MANY_ARGUMENTS = {
    "api/routes/models.py ask_for_model": "FastAPI gives a route what it declares",
    "client.py Client.trace": "the library's call over HTTP",
    "service/model.py model": "the library's call, with the inputs of a photo by name",
    "service/model.py model_views": "the library's call, with the inputs of many photos by name",
    "service/model.py model_video": "the library's call, with the inputs of a clip by name",
    "service/model.py sketch": "the library's call, with the inputs of sketches by name",
    "service/sibling_models.py siblings": "the library's call, with what siblings are to be like by name",
    "service/trace.py trace": "the library's call, with all that a live tree grows of by name",
}
"""Functions that may have more arguments, and why: at most ten."""
DOCUMENTED_SHARE = 0.9
ARRAY = re.compile(r"NDArray|Floats|Indices|Mask|Photo\b|Picture|Image\b|Points")
_LENGTH = r"(?:\d[\d_ ]*|\.\.\.|(?:\d )?[a-z]{1,3}\d?|[a-z_]+s|height|width|\d or \d)(?: ?[-+*/] ?\w+)*"
SHAPE = re.compile(rf"\(\s*{_LENGTH}\s*,(?:\s*{_LENGTH}\s*,)*(?:\s*{_LENGTH}\s*)?\)|\bscalars?\b|\b0-d\b")
"""A shape such as (n, 3), (h, w) or (n,), or the word for a single number."""
UNIT = re.compile(
    r"\b(?:px|pixels?|texels?|cells?|tiles?|metres?|m|radians?|rad|degrees?|seconds?|s|hertz|Hz|kg|bytes|bits?"
    r"|sRGB|RGBA?|Lab|CIE\w*|alpha|0 to 255|0 to 1|-1 to 1"
    r"|share[sd]?|factors?|ratios?|weights?|variances?|probabilit\w+|odds|costs?|units?|unitless|dimensionless"
    r"|count\w*|steps?|iterations?|index|indices|ids?|flags?|masks?|boolean|bools?|true|whether|which"
    r"|texture coordinates|quaternions?)\b"
)
"""A unit, a range, or the word for a number that has none."""


class Found(NamedTuple):
    """A function of the package: where it is, under which name, and whether others may call it."""

    name: str
    node: Function
    public: bool


def functions() -> Iterator[Found]:
    for path in sorted(PACKAGE.rglob("*.py")):
        if "migrations" not in path.parts:
            yield from _within(ast.parse(path.read_text()), f"{path.relative_to(PACKAGE).as_posix()} ", public=True)


def _within(parent: ast.AST, prefix: str, public: bool) -> Iterator[Found]:
    for node in ast.iter_child_nodes(parent):
        if isinstance(node, Function):
            yield Found(f"{prefix}{node.name}", node, public and not node.name.startswith("_"))
            yield from _within(node, f"{prefix}{node.name}.", public=False)
        elif isinstance(node, ast.ClassDef):
            yield from _within(node, f"{prefix}{node.name}.", public and not node.name.startswith("_"))
        else:
            yield from _within(node, prefix, public)


def _arguments(node: Function) -> list[ast.arg]:
    given = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
    return [one for one in given if one.arg not in ("self", "cls")]


def test_functions_have_few_arguments() -> None:
    many = {one.name for one in functions() if len(_arguments(one.node)) > MOST_ARGUMENTS}
    assert sorted(many - set(MANY_ARGUMENTS)) == []
    assert sorted(set(MANY_ARGUMENTS) - many) == [], "exceptions that nothing needs any more"
    assert len(MANY_ARGUMENTS) <= 10


def test_functions_are_short() -> None:
    lines = {one.name: (one.node.end_lineno or 0) - one.node.lineno + 1 for one in functions()}
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_files_are_short() -> None:
    lines = {str(path.relative_to(PACKAGE)): len(path.read_text().splitlines()) for path in PACKAGE.rglob("*.py")}
    assert {name: count for name, count in lines.items() if count > MOST_FILE_LINES} == {}


def _has_arrays(node: Function) -> bool:
    types = [one.annotation for one in _arguments(node)] + [node.returns]
    return any(ARRAY.search(ast.unparse(type_)) for type_ in types if type_ is not None)


@pytest.mark.parametrize("form", [SHAPE, UNIT], ids=["shapes", "units"])
def test_public_array_functions_of_the_core_state(form: re.Pattern[str]) -> None:
    of_arrays = [one for one in functions() if one.name.startswith("core/") and one.public and _has_arrays(one.node)]
    silent = [one.name for one in of_arrays if not form.search(ast.get_docstring(one.node) or "")]
    assert len(of_arrays) > 100
    assert len(silent) <= (1 - DOCUMENTED_SHARE) * len(of_arrays), "\n".join(silent)


@pytest.mark.parametrize("text", ["(n, 3) points", "lines (2 n, 2)", "an image (h, w, 3)", "(n,) lengths", "a scalar"])
def test_a_shape_is_seen(text: str) -> None:
    assert SHAPE.search(text)


@pytest.mark.parametrize("text", ["a stroke (crown, trunk)", "(Tan et al. 2008, section 3)", "points (in the photo)"])
def test_other_brackets_are_no_shape(text: str) -> None:
    assert not SHAPE.search(text)


def _imports(parent: ast.AST) -> Iterator[str]:
    """Yield what a module imports, in its functions too, but not what it imports for the type checker alone."""
    for node in ast.iter_child_nodes(parent):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif not (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"):
            yield from _imports(node)


def test_no_imports_circle() -> None:
    known = modules()
    imported = {
        name: {other.removeprefix("treestroke.") for other in _imports(ast.parse(path.read_text()))}
        & known.keys() - {name}
        for name, path in known.items()
    }
    try:
        TopologicalSorter(imported).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))
