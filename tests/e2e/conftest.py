"""A real service with its worker, and Debian's Chromium before it, which draws WebGL without a GPU."""

import os
import shutil
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, sync_playwright
from tests.e2e.visitor import PATIENCE_MS, Visitor
from tests.running import serving

from treestroke.api.routes.page import PAGE

HERE = Path(__file__).parent
_FEATURES_OFF = (
    "WebUIOmniboxPopup",  # two renderers beside each page, for an address bar that nobody sees
    "WebUIOmniboxAimPopup",
    # Chromium takes the last list of these alone, so Playwright's own, as far as it matters here, stands here again.
    "AimEnabled",
    "AvoidUnnecessaryBeforeUnloadCheckSync",
    "DestroyProfileOnBrowserClose",
    "HttpsFirstBalancedModeAutoEnable",
    "HttpsUpgrades",
    "LensOverlay",
    "MediaRouter",
    "NetworkTimeServiceQuerying",
    "OptimizationHints",
    "PaintHolding",
    "PreconnectToSearch",
)
FLAGS = (
    f"--disable-features={','.join(_FEATURES_OFF)}",
    "--enable-unsafe-swiftshader",  # for WebGL only: the page itself is put together without it, which is quicker
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
OpenPage = Callable[..., Visitor]
_OUTCOME = pytest.StashKey[bool]()


@dataclass(frozen=True)
class Service:
    """A service that runs, and a client that asks it beside the page."""

    url: str
    client: httpx.Client

    def models(self) -> list[dict[str, Any]]:
        """List its models, newest first."""
        return list(self.client.get("/v1/models", params={"limit": 100}).json()["models"])


def _missing(what: str) -> None:
    assert os.environ.get("CI") != "true", what
    pytest.skip(what)


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One service for all tests of a process: what one of them has grown, the others get at once."""
    if not (PAGE / "index.html").is_file():
        _missing("the page is not built: run `make page`")
    with serving(tmp_path_factory.mktemp("e2e") / "data") as url, httpx.Client(base_url=url, timeout=70) as client:
        yield Service(url, client)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Chromium; it ends with the file, since until then Playwright's event loop takes asyncio's place."""
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    if executable is None:
        _missing("chromium is not installed")
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=executable, args=list(FLAGS))
        yield launched
        launched.close()


@pytest.fixture
def open_page(service: Service, browser: Browser, request: pytest.FixtureRequest) -> Iterator[OpenPage]:
    """Open a page as somebody else each time; at the end none may have complained."""
    visitors: list[Visitor] = []
    with ExitStack() as closing:

        def opened(
            path: str = "/",
            viewport: tuple[int, int] = (1360, 720),
            touch: bool = False,
            dark: bool = False,
            still: bool = True,
            script: str = "",
        ) -> Visitor:
            """Open a path of the page; `touch` has fingers in place of a mouse, `still` wants no motion.

            Motion is for tests that look at it: without a GPU, a tree that grows and a flight to it take seconds.
            ``script`` runs before the page's own, to make another browser of this one.
            """
            context = browser.new_context(
                viewport={"width": viewport[0], "height": viewport[1]},
                has_touch=touch,
                is_mobile=touch,
                color_scheme="dark" if dark else "light",
                reduced_motion="reduce" if still else "no-preference",
                locale="en-GB",
                service_workers="block",
            )
            closing.callback(context.close)
            context.set_default_timeout(PATIENCE_MS)
            if script:
                context.add_init_script(script)
            visitor = Visitor(context.new_page(), service.url)
            visitors.append(visitor)
            visitor.open(path)
            return visitor

        yield opened
        if not request.node.stash.get(_OUTCOME, False):
            for number, visitor in enumerate(visitors):
                visitor.shot(f"failed-{request.node.name}-{number}")
    assert [complaint for visitor in visitors for complaint in visitor.unexpected()] == []


@pytest.fixture
def visitor(open_page: OpenPage) -> Visitor:
    """Somebody with a mouse at the page's beginning."""
    return open_page()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what needs a browser: one that draws without a GPU leaves little room beside it."""
    for item in items:
        if HERE in item.path.parents:
            item.add_marker("browser")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keep for the fixtures whether the test itself passed."""
    report = yield
    if report.when == "call":
        item.stash[_OUTCOME] = report.passed
    return report
