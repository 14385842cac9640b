"""HTTP statuses are decided in `api.errors` alone: elsewhere a problem has a code, and a success a named status."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

API = Path(__file__).parents[2] / "backend" / "treestroke" / "api"
HOME = API / "errors.py"
STATUSES = range(100, 600)
RESPONSES = ("Response", "HTTPException")
"""How the names of the classes end whose second argument, or ``status_code``, is a status."""


def statuses(source: str) -> list[int]:
    """Return the lines on which a number is used as an HTTP status."""
    return sorted({line for node in ast.walk(ast.parse(source)) for line in _in_node(node)})


def _in_node(node: ast.AST) -> Iterator[int]:
    given: list[ast.expr] = []
    if isinstance(node, ast.Call):
        given = [keyword.value for keyword in node.keywords if keyword.arg in ("status_code", "status")]
        if _name(node.func).endswith(RESPONSES):
            given += node.args[:2]
        if _name(node.func) in ("documented", "problem", "Refusal"):
            given += node.args
    elif isinstance(node, ast.Compare) and "status" in ast.dump(node):
        given = [
            part for side in (node.left, *node.comparators) for part in ast.walk(side) if isinstance(part, ast.expr)
        ]
    elif isinstance(node, ast.Assign | ast.AnnAssign) and "status" in _targets(node):
        given = [part for part in ast.walk(node) if isinstance(part, ast.expr)]
    elif isinstance(node, ast.Dict):
        given = [key for key in node.keys if key is not None]
    yield from (one.lineno for one in given if isinstance(one, ast.Constant) and _is_status(one.value))


def _name(function: ast.expr) -> str:
    return ast.unparse(function).rpartition(".")[2]


def _targets(node: ast.Assign | ast.AnnAssign) -> str:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return " ".join(ast.unparse(target) for target in targets)


def _is_status(value: object) -> bool:
    """Tell whether a value is a status, as a number or as a key of OpenAPI's responses."""
    number = int(value) if isinstance(value, str) and value.isdecimal() else value
    return type(number) is int and number in STATUSES


def test_only_errors_uses_numbers_as_http_statuses() -> None:
    used = {
        str(path.relative_to(API)): lines
        for path in sorted(API.rglob("*.py"))
        if path != HOME and (lines := statuses(path.read_text()))
    }
    assert used == {}


@pytest.mark.parametrize(
    "source",
    [
        'raise HTTPException(415, "send JSON")',
        "Response(status_code=304)",
        "PlainTextResponse(text, 404)",
        "responses = {200: {}}",
        "documented(403, 404)",
        "if response.status_code != 503: pass",
        "status = 200 if finished else 202",
        "response.status_code = 503",
        'router.post("", status_code=202)',
        'responses = {"422": {}}',
    ],
)
def test_a_status_written_as_a_number_is_found(source: str) -> None:
    assert statuses(source) == [1]


@pytest.mark.parametrize("source", ["MAX = 500", "limit(400)", "x = {'width': 200}", "if size > 404: pass"])
def test_other_numbers_are_no_statuses(source: str) -> None:
    assert statuses(source) == []
