"""Names that are written to break out of the page, and files that are HTML too: nothing of them is ever run."""

from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect
from tests.api import drawn
from tests.e2e.conftest import PATIENCE_MS
from tests.e2e.test_sharing import Shared
from tests.e2e.visitor import Visitor
from tests.hosted import Hosted, hosting
from tests.postgres import PostgresServer

from treestroke.api.routes.page import PAGE

RUN = "document.documentElement.dataset.broken = 1"
HOSTILE = f'"\'><img src=x onerror="{RUN}"></title><script>{RUN}</script>'
WHO, TEAM, TAG = f"Ann{HOSTILE}", f"Oaks{HOSTILE}", '<svg onload="">'


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[tuple[Hosted, Shared, str]]:
    """Run a service whose team, owner, key, tree and tag are called so; give it, its tree and the owner's key."""
    if not (PAGE / "share.html").is_file():
        pytest.skip("the page is not built: run `make page`")
    folder = tmp_path_factory.mktemp("hostile") / "data"
    with hosting(folder, postgres.fresh_with_tables()) as hosted:
        shared, key = Shared(hosted, folder), hosted.key("owner")
        who = hosted.ask(key, "GET", "/v1/session").json()["member"]["id"]
        hosted.ask(key, "PATCH", f"/v1/members/{who}", json={"name": WHO})
        hosted.ask(key, "PATCH", "/v1/team", json={"name": TEAM})
        hosted.ask(key, "POST", "/v1/keys", json={"name": HOSTILE})
        named = hosted.ask(key, "PATCH", f"/v1/models/{shared.model}", json={"name": HOSTILE, "tags": [TAG]})
        assert named.status_code == 200, named.text
        yield hosted, shared, key


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 1360, "height": 720}, reduced_motion="reduce", locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    yield context.new_page()
    context.close()


def nothing_ran(visitor: Visitor) -> bool:
    return visitor.page.evaluate("document.documentElement.dataset.broken === undefined") and not visitor.unexpected()


def test_the_page_shows_hostile_names_as_they_are_written(found: tuple[Hosted, Shared, str], page: Page) -> None:
    _, shared, key = found
    visitor = Visitor(page, shared.url)
    visitor.expect_complaint(r"status of 401")
    visitor.open()
    page.get_by_role("dialog", name="Sign in").get_by_label("Key", exact=True).fill(key)
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Gallery").click()
    gallery = page.get_by_role("dialog")
    expect(gallery.get_by_text(HOSTILE).first).to_be_visible()
    expect(gallery.get_by_text(TAG).first).to_be_visible()
    assert nothing_ran(visitor)
    page.keyboard.press("Escape")
    page.get_by_role("button", name=f"Account of {WHO}", exact=True).click()
    expect(page.get_by_role("button", name="Sign out")).to_be_visible()
    assert nothing_ran(visitor)


def test_the_page_of_a_link_shows_a_hostile_name_as_it_is_written(
    found: tuple[Hosted, Shared, str], page: Page
) -> None:
    _, shared, _ = found
    visitor = Visitor(page, shared.url)
    page.goto(f"{shared.url}{shared.link(photo=True)['path']}")
    expect(page.get_by_role("heading", name=HOSTILE)).to_be_visible()
    assert page.title().startswith(HOSTILE)
    assert nothing_ran(visitor)


def test_a_photo_that_is_html_too_is_opened_as_a_picture_alone(found: tuple[Hosted, Shared, str], page: Page) -> None:
    hosted, shared, key = found
    html = f"<html><script>{RUN}</script>".encode()
    refused = hosted.ask(key, "POST", "/v1/photos", content=html)
    assert refused.status_code == 422
    both = hosted.ask(key, "POST", "/v1/photos", content=drawn.encoded() + html)
    assert both.status_code == 201, both.text
    at = f"/v1/photos/{both.json()['id']}/image"
    answer = hosted.ask(key, "GET", at)
    assert html not in answer.content
    kept(answer)
    page.set_extra_http_headers({"Authorization": f"Bearer {key}"})
    page.goto(f"{shared.url}{at}")
    assert page.evaluate("document.contentType") == "image/png"
    kept(hosted.ask(key, "GET", f"/v1/models/{shared.model}/tree.glb"))


def kept(answer: httpx.Response) -> None:
    """See that browsers are told to take a file for nothing but what it is, and to run nothing of it."""
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert "default-src 'self'" in answer.headers["Content-Security-Policy"]
    assert "html" not in answer.headers["Content-Type"]
