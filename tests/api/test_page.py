"""The built page as the service gives it, and what the policy of its content asks of it."""

import asyncio
import gzip
import os
import re
from html.parser import HTMLParser
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from treestroke.api.routes.page import PAGE, add_page

MOST_FIRST_BYTES, MOST_SCRIPT_BYTES, MOST_LATER_BYTES = 65_000, 130_000, 22_000
"""Compressed: what is loaded before the page is shown, and all of it; three.js and its decoder lie beside them."""
TYPES = {
    "html": "text/html; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "svg": "image/svg+xml",
    "jpg": "image/jpeg",
    "png": "image/png",
    "webp": "image/webp",
    "json": "application/json",
}


class Read(HTMLParser):
    """What a page names and what it holds inline."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.named: list[str] = []
        self.inline: list[str] = []
        self._in_script = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self._in_script = tag == "script"
        self.named += [value for name in ("src", "href") if (value := given.get(name))]
        self.inline += [name for name in given if name == "style" or name.startswith("on")]
        self.inline += [tag] if tag == "style" else []

    def handle_data(self, data: str) -> None:
        self.inline += [data] if self._in_script and data.strip() else []

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False


@pytest.fixture(scope="module")
def built() -> Path:
    if not (PAGE / "index.html").is_file():
        assert os.environ.get("CI") != "true", "the page is not built"
        pytest.skip("the page is not built: run `make page`")
    return PAGE


@pytest.fixture
def index(built: Path, client: httpx.Client) -> Read:
    return Read(client.get("/").text)


def unbuilt(folder: Path, path: str) -> httpx.Response:
    """Ask a service of a source folder where the page was not built."""
    app = FastAPI()
    add_page(app, folder / "page")

    async def ask() -> httpx.Response:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://127.0.0.1") as client:
            return await client.get(path)

    return asyncio.run(ask())


def test_the_page_is_asked_for_anew_and_not_sent_anew(built: Path, client: httpx.Client) -> None:
    answer = client.get("/")
    assert (answer.status_code, answer.headers["content-type"]) == (200, TYPES["html"])
    assert answer.headers["cache-control"] == "no-cache"
    again = client.get("/", headers={"If-None-Match": answer.headers["etag"]})
    assert (again.status_code, again.content, again.headers["cache-control"]) == (304, b"", "no-cache")
    assert again.headers["content-security-policy"] == answer.headers["content-security-policy"]


def test_the_page_has_a_head(built: Path, client: httpx.Client) -> None:
    whole, head = client.get("/"), client.head("/")
    assert (head.status_code, head.content) == (200, b"")
    assert head.headers["content-length"] == str(len(whole.content))
    assert head.headers["content-security-policy"] == whole.headers["content-security-policy"]


def test_the_policy_lets_nothing_in_from_elsewhere_and_nothing_inline(built: Path, client: httpx.Client) -> None:
    policy = client.get("/").headers["content-security-policy"]
    rules = {name: sources.split() for name, _, sources in (rule.strip().partition(" ") for rule in policy.split(";"))}
    assert rules == {
        "default-src": ["'self'"],
        "img-src": ["'self'", "blob:", "data:"],
        "connect-src": ["'self'", "blob:", "data:"],
        "media-src": ["'self'", "blob:"],
        "object-src": ["'none'"],
        "script-src": ["'self'", "'wasm-unsafe-eval'"],
        "base-uri": ["'none'"],
        "frame-ancestors": ["'none'"],
    }


def test_the_page_has_nothing_inline(index: Read) -> None:
    assert index.inline == []


def test_what_the_page_names_is_of_this_service_and_is_there(index: Read, client: httpx.Client) -> None:
    assert [name for name in index.named if name.endswith(".js")]
    assert [name for name in index.named if not name.startswith("/page/")] == []
    assert {name: client.get(name).status_code for name in index.named} == dict.fromkeys(index.named, 200)


def test_every_file_of_the_page_has_its_type_and_is_kept_as_long_as_it_holds(built: Path, client: httpx.Client) -> None:
    files = [path for path in built.rglob("*") if path.is_file() and not path.name.startswith(".")]
    assert len(files) > 2
    for path in files:
        name = path.relative_to(built).as_posix()
        answer = client.get(f"/page/{name}")
        assert answer.content == path.read_bytes()
        assert answer.headers["content-type"] == TYPES[path.suffix[1:]], name
        hashed = name.startswith("assets/")
        assert not hashed or re.search(r"-[\w-]{8}\.\w+$", name)
        wanted = "public, max-age=31536000, immutable" if hashed else "no-cache"
        assert answer.headers["cache-control"] == wanted, name


def test_the_pages_own_scripts_are_light(built: Path) -> None:
    own = {path.name: len(gzip.compress(path.read_bytes())) for path in built.glob("assets/*.js")}
    assert 0 < sum(size for name, size in own.items() if name.startswith("index-")) < MOST_FIRST_BYTES
    three, later = ("three-", "meshopt_decoder"), ("filmParts-", "Siblings-", "groveView-", "accountParts-")
    assert [name for name in (*three, *later) if not any(own_name.startswith(name) for own_name in own)] == []
    assert sum(size for name, size in own.items() if not name.startswith((*three, *later))) < MOST_SCRIPT_BYTES
    assert sum(size for name, size in own.items() if name.startswith(later)) < MOST_LATER_BYTES


def test_a_file_that_the_page_has_no_more_is_not_kept_as_missing(client: httpx.Client) -> None:
    answer = client.get("/page/assets/index-00000000.js")
    assert (answer.status_code, answer.headers["cache-control"]) == (404, "no-store")


@pytest.mark.parametrize("path", ["/page/../app.py", "/page/%2e%2e/app.py", "/page/..%2fapp.py", "/page//etc/passwd"])
def test_nothing_beside_the_page_is_served(client: httpx.Client, path: str) -> None:
    assert client.get(path).status_code == 404


def test_the_icon_that_browsers_ask_for_is_no_error(client: httpx.Client, tmp_path: Path) -> None:
    assert client.get("/favicon.ico").status_code in (200, 204)
    assert unbuilt(tmp_path, "/favicon.ico").status_code == 204


def test_a_page_that_was_not_built_says_how_it_is(tmp_path: Path) -> None:
    answer = unbuilt(tmp_path, "/")
    assert (answer.status_code, answer.headers["content-type"]) == (404, "text/plain; charset=utf-8")
    assert "make page" in answer.text
    assert unbuilt(tmp_path, "/page/assets/index.js").status_code == 404
