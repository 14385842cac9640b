"""The documents' form: short lines, tables that can be read as source, links that lead somewhere."""

import json
import re

import pytest
from tests.architecture.documents import PAGES, anchors, cells, fences, prose, section, tables, text_of
from tests.architecture.names import DOCUMENTS, ROOT

WIDEST_LINE, WIDEST_CELL, LONGEST_README = 120, 100, 130
LANGUAGES = {"sh", "python", "json", "console", "text"}
LINK = re.compile(r"!?\[([^\]]*)\]\(([^)#:]*)(?:#([^)]*))?\)")


def test_the_readme_is_short() -> None:
    assert len(text_of("README.md").splitlines()) <= LONGEST_README


@pytest.mark.parametrize("name", PAGES)
def test_no_line_is_too_long(name: str) -> None:
    lines = enumerate(text_of(name).splitlines(), start=1)
    assert [n for n, line in lines if len(line) > WIDEST_LINE and not line.startswith("|")] == []


@pytest.mark.parametrize("name", PAGES)
def test_no_cell_of_a_table_is_a_paragraph(name: str) -> None:
    rows = [row for table in tables(prose(name)) for row in table]
    assert [cell for row in rows for cell in cells(row) if len(cell) > WIDEST_CELL and set(cell) != {"-"}] == []


@pytest.mark.parametrize("name", PAGES)
def test_the_columns_of_every_table_are_padded(name: str) -> None:
    for table in tables(prose(name)):
        ends = {tuple(found.start() for found in re.finditer(r"(?<!\\)\|", row)) for row in table}
        assert len(ends) == 1, table[0]


@pytest.mark.parametrize("name", PAGES)
def test_every_page_but_the_readme_begins_with_what_it_is_for_and_leads_back(name: str) -> None:
    if name != "README.md":
        assert re.match(r"# .+\n\nThis page tells [^#]+Back to the\s\[README\]\((../)?README.md\).\n", text_of(name))


def test_the_readme_leads_to_every_page() -> None:
    linked = {path for _, path, _ in LINK.findall(section("README.md", "Read on"))}
    assert linked >= set(PAGES) - {"README.md"}


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_link_leads_somewhere(name: str) -> None:
    document = ROOT / name
    links = LINK.findall(prose(name))
    missing = [path for _, path, _ in links if path and not (document.parent / path).exists()]
    assert missing == []
    for _, path, anchor in links:
        target = (document.parent / path).resolve().relative_to(ROOT).as_posix() if path else name
        assert not anchor or anchor in anchors(target), f"{path}#{anchor}"


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_picture_is_described(name: str) -> None:
    assert [path for words, path in re.findall(r"!\[([^\]]*)\]\(([^)]+)\)", prose(name)) if len(words) < 20] == []


@pytest.mark.parametrize("name", PAGES)
def test_every_fence_says_what_it_is(name: str) -> None:
    assert {fence.language for fence in fences(name)} <= LANGUAGES
    assert re.search(r"^    \S", re.sub(r"^ +(- |\d\. ).*(\n  .*)*", "", prose(name), flags=re.M), re.M) is None


@pytest.mark.parametrize("name", [name for name in PAGES if fences(name, "json")])
def test_every_json_block_is_json(name: str) -> None:
    for fence in fences(name, "json"):
        assert json.loads(fence.text)


def test_a_link_that_leads_nowhere_is_found() -> None:
    assert LINK.findall("[a](b.md#c) ![d](e.jpg) [f](#g)") == [("a", "b.md", "c"), ("d", "e.jpg", ""), ("f", "", "g")]
    assert "more-files" in anchors("docs/settings.md")
    assert "no-such-heading" not in anchors("docs/settings.md")
