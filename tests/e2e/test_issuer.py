"""Signing in at an issuer, of another site than the service, by a browser that follows where it is sent."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from tests.e2e.conftest import PATIENCE_MS
from tests.e2e.visitor import Visitor
from tests.hosted import SECRET
from tests.issuer import CLIENT, TestIssuer, issuing
from tests.issuer import SECRET as CLIENT_SECRET
from tests.postgres import PostgresServer
from tests.running import serving

from treestroke.api.routes.page import PAGE
from treestroke.service.team_setup import Person, add_key
from treestroke.store.database import Database
from treestroke.wire_accounts import KeyRequest


@pytest.fixture(scope="module")
def issuer() -> Iterator[TestIssuer]:
    with issuing("localhost") as found:
        yield found


@pytest.fixture(scope="module")
def address(issuer: TestIssuer, postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Run a hosted service that knows the issuer; give its address."""
    if not (PAGE / "index.html").is_file():
        pytest.skip("the page is not built: run `make page`")
    folder: Path = tmp_path_factory.mktemp("issuer")
    url = postgres.fresh_with_tables()
    database = Database(folder, url)
    add_key(database, SECRET, Person("Oaks", "Owner", "owner"), KeyRequest(name="first"))
    database.close()
    oidc = {"oidc_issuer": issuer.url, "oidc_client": CLIENT, "oidc_client_secret": CLIENT_SECRET, "oidc_team": "Oaks"}
    with serving(folder / "data", database_url=url, secret=SECRET, workers=0, tracers=1, **oidc) as found:
        yield found


def test_one_comes_back_from_the_issuer_signed_in_or_is_told_why_not(
    issuer: TestIssuer, address: str, browser: Browser
) -> None:
    context = browser.new_context(viewport={"width": 1360, "height": 720}, reduced_motion="reduce", locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    visitor = Visitor(page, address)
    visitor.expect_complaint(r"status of 401")
    visitor.expect_complaint(rf"asked elsewhere: {issuer.url}/authorize")
    visitor.open()
    way = page.get_by_role("link", name="Sign in with localhost")
    expect(way).to_be_visible()
    assert visitor.violations() == []
    visitor.shot("sign-in-issuer")
    issuer.refuses = True
    way.click()
    expect(page.get_by_role("alert").filter(has_text="You were not signed in there")).to_be_visible()
    assert page.url == f"{address}/"
    issuer.refuses = False
    way.click()
    expect(page.get_by_role("button", name="Account of Ann Bauer")).to_be_visible()
    expect(page.get_by_role("dialog")).to_have_count(0)
    context.close()
    assert visitor.unexpected() == []
