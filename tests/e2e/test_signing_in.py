"""The page of a hosted service: signing in, a session that ends in the midst of drawing, keys and members."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from tests.e2e.conftest import PATIENCE_MS
from tests.e2e.visitor import Visitor
from tests.hosted import SECRET
from tests.postgres import PostgresServer
from tests.running import serving

from treestroke.service.team_setup import Person, add_key
from treestroke.store.database import Database
from treestroke.wire_accounts import KeyRequest

TRUNK = [(500, 900), (500, 500)]
WITHOUT_SESSION = r"status of 401"
"""What Chromium says of a request that nobody has signed in for."""


@pytest.fixture(scope="module")
def hosted(postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Database]]:
    """Run a hosted service that this machine's browsers reach without TLS; give its address and its database."""
    folder: Path = tmp_path_factory.mktemp("hosted")
    url = postgres.fresh_with_tables()
    database = Database(folder, url)
    with serving(folder / "data", database_url=url, secret=SECRET, workers=0, tracers=1) as address:
        yield address, database
    database.close()


@pytest.fixture
def visitor(hosted: tuple[str, Database], browser: Browser) -> Iterator[Visitor]:
    """Somebody with a mouse who has not signed in; at the end their page may not have complained of anything else."""
    context = browser.new_context(viewport={"width": 1360, "height": 720}, reduced_motion="reduce", locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    visitor = Visitor(context.new_page(), hosted[0])
    visitor.expect_complaint(WITHOUT_SESSION)
    visitor.open()
    yield visitor
    context.close()
    assert visitor.unexpected() == []


def make_key(database: Database) -> str:
    """Make a key of an owner."""
    wanted = KeyRequest(name="browser", scopes=["trees", "team"])
    return add_key(database, SECRET, Person("Oaks", "Ann Bauer", "owner"), wanted).key


def sign_in(visitor: Visitor, key: str) -> None:
    """Type a key, and press Enter."""
    screen = visitor.page.get_by_role("dialog", name="Sign in")
    screen.get_by_label("Key", exact=True).fill(key)
    visitor.page.keyboard.press("Enter")


def test_one_signs_in_by_a_key_and_goes_on_after_the_session_has_ended(
    visitor: Visitor, hosted: tuple[str, Database]
) -> None:
    page = visitor.page
    screen = page.get_by_role("dialog", name="Sign in")
    sign_in(visitor, "ts_mistyped")
    expect(screen.get_by_role("alert")).to_contain_text("mistyped")
    assert visitor.violations() == []
    key = make_key(hosted[1])
    sign_in(visitor, key)
    expect(screen).to_be_hidden()
    page.get_by_role("button", name="Draw it yourself").click()
    page.context.clear_cookies()
    visitor.draw(TRUNK, button="right")
    expect(page.get_by_role("dialog", name="Sign in again")).to_be_visible()
    sign_in(visitor, key)
    visitor.wait_until_traced()
    expect(page.get_by_role("dialog")).to_have_count(0)
    visitor.wait_for_preview("live")


def test_an_owner_makes_a_key_for_a_new_member_and_the_keyboard_is_enough(
    visitor: Visitor, hosted: tuple[str, Database]
) -> None:
    page = visitor.page
    sign_in(visitor, make_key(hosted[1]))
    menu = page.get_by_role("button", name="Account of Ann Bauer")
    visitor.tab_to(menu)
    page.keyboard.press("Enter")
    visitor.tab_to(page.get_by_role("button", name="Team"))
    page.keyboard.press("Enter")
    visitor.tab_to(page.get_by_label("Name", exact=True))
    page.keyboard.type("Bo")
    page.keyboard.press("Enter")
    expect(page.get_by_label("Role of Bo")).to_have_value("member")
    assert visitor.violations() == []
    part = page.get_by_role("tabpanel", name="Team")
    visitor.tab_to(part.get_by_label("What it is for"))
    page.keyboard.type("Bo's browser")
    page.keyboard.press("Enter")
    made = part.get_by_label("The key", exact=True)
    expect(made).to_be_focused()
    key = made.input_value()
    page.keyboard.press("Escape")
    menu.click()
    page.get_by_role("button", name="Sign out").click()
    sign_in(visitor, key)
    expect(page.get_by_role("button", name="Account of Bo")).to_be_visible()
