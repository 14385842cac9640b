"""The documents as tests read them: their fences, sections, tables and anchors."""

import re
from collections.abc import Iterator
from itertools import groupby
from typing import NamedTuple

from tests.architecture.names import DOCUMENTS, ROOT

_REFERENCES = ("ARCHITECTURE.md", "docs/conventions.md", "docs/glossary.md", "docs/papers.md")
"""Documents for those who change treestroke, whose tables hold sentences."""
PAGES = [name for name in DOCUMENTS if name not in _REFERENCES and not name.startswith("docs/decisions/")]
"""Documents for those who use treestroke."""
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
_HEADING = re.compile(r"^#+ (.+)$", re.M)
_BETWEEN_CELLS = re.compile(r"(?<!\\)\|")


class Fence(NamedTuple):
    """A fenced block: its language, and its text."""

    language: str
    text: str


def text_of(name: str) -> str:
    """Return a document's text."""
    return (ROOT / name).read_text()


def fences(name: str, language: str | None = None) -> list[Fence]:
    """Return a document's fenced blocks, perhaps only those in one language."""
    found = [Fence(*parts) for parts in FENCE.findall(text_of(name))]
    return [fence for fence in found if language in (None, fence.language)]


def prose(name: str) -> str:
    """Return a document's text without its fenced blocks."""
    return FENCE.sub("", text_of(name))


def anchors(name: str) -> set[str]:
    """Return the anchors of a document's headings, as GitHub names them."""
    plain = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in _HEADING.findall(prose(name)))
    return {heading.replace(" ", "-") for heading in plain}


def section(name: str, heading: str) -> str:
    """Return what follows a heading of a document, up to the next heading of any level."""
    (body,) = re.findall(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)", prose(name), re.M | re.S)
    return str(body)


def tables(text: str) -> Iterator[list[str]]:
    """Yield the tables of a text, each as the lines of its source."""
    for is_table, lines in groupby(text.splitlines(), lambda line: line.startswith("|")):
        if is_table:
            yield list(lines)


def cells(row: str) -> list[str]:
    """Return the cells of a row of a table, without the blanks that pad them."""
    return [cell.strip() for cell in _BETWEEN_CELLS.split(row)[1:-1]]


def rows(text: str) -> list[list[str]]:
    """Return the cells of all rows of a text's tables, without the tables' heads."""
    return [cells(row) for table in tables(text) for row in table[2:]]


def named(cell: str) -> list[str]:
    """Return what a text names in backticks."""
    return re.findall(r"`([^`\n]+)`", cell)
