"""The page opens in a real browser."""

from playwright.sync_api import expect
from tests.e2e.visitor import Visitor


def test_the_page_opens_without_a_complaint(visitor: Visitor) -> None:
    expect(visitor.page).to_have_title("treestroke")
    visitor.shot("opened")
