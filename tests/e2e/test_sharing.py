"""A tree that was shared, seen by somebody who has only its link."""

from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect
from tests.api.sketched import FRONT, SIDE
from tests.e2e.visitor import PATIENCE_MS, SHOTS, Visitor
from tests.hosted import ORIGIN, Hosted, hosting
from tests.postgres import PostgresServer
from tests.rows import add_model

import treestroke
from treestroke.api.routes.page import PAGE
from treestroke.codec.image import encode_png
from treestroke.store.blobs import open_blobs
from treestroke.store.scope import Scope
from treestroke.store.tables import File


class Shared:
    """A hosted service with a tree, to which links are made."""

    def __init__(self, hosted: Hosted, folder: Path) -> None:
        self._hosted, self._key = hosted, hosted.key("owner")
        who = hosted.ask(self._key, "GET", "/v1/session").json()
        tree = treestroke.sketch(FRONT, SIDE, {"height": 9})
        scope = Scope(who["team"]["id"], who["member"]["id"])
        database, blobs = hosted.database.of(scope), open_blobs(hosted.database, folder).of(scope)
        photo = blobs.put(encode_png(np.full((600, 400, 3), 150, dtype=np.uint8)))
        row = add_model(database, {"photo": photo}, status="succeeded", name="The old oak", report=tree.report)
        files = {"tree.glb": tree.files["tree.glb"], "preview.png": encode_png(tree.preview())}
        stored = {name: blobs.put(content) for name, content in files.items()}
        with database.writing() as session:
            for name, content in files.items():
                session.add(File(model=row.id, name=name, blob=stored[name], bytes=len(content)))
        self.model = row.id
        self.url = str(hosted.client.base_url).rstrip("/")

    def link(self, **terms: object) -> dict[str, str]:
        """Make a link; ``path`` leads to it."""
        made = self._hosted.ask(self._key, "POST", f"/v1/models/{self.model}/shares", json=terms).json()
        return {**made, "path": made["url"].removeprefix(ORIGIN)}

    def revoke(self, id: str) -> None:
        assert self._hosted.ask(self._key, "DELETE", f"/v1/shares/{id}").status_code == 204


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[Shared]:
    if not (PAGE / "share.html").is_file():
        pytest.skip("the page is not built: run `make page`")
    folder = tmp_path_factory.mktemp("sharing") / "data"
    with hosting(folder, postgres.fresh_with_tables()) as hosted:
        yield Shared(hosted, folder)


@pytest.fixture
def page(browser: Browser, request: pytest.FixtureRequest) -> Iterator[Page]:
    """Somebody's phone, in the dark where the test says so."""
    dark = getattr(request, "param", False)
    context = browser.new_context(
        viewport={"width": 390, "height": 844},
        is_mobile=True,
        has_touch=True,
        color_scheme="dark" if dark else "light",
        reduced_motion="reduce",
    )
    context.set_default_timeout(PATIENCE_MS)
    yield context.new_page()
    context.close()


@contextmanager
def elsewhere(content: str) -> Iterator[str]:
    """Serve one page of another origin, and give its address."""

    class Answer(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(content.encode())

    server = ThreadingHTTPServer(("127.0.0.1", 0), Answer)
    Thread(target=server.serve_forever, daemon=True).start()
    yield f"http:{'//'}127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("page", [False, True], indirect=True, ids=["light", "dark"])
def test_a_link_shows_the_tree_on_a_phone(shared: Shared, page: Page, request: pytest.FixtureRequest) -> None:
    visitor, path = Visitor(page, shared.url), shared.link(photo=True)["path"]
    page.goto(shared.url + path)
    visitor.wait_for_preview("model")
    expect(page.get_by_role("heading", name="The old oak")).to_be_visible()
    expect(page.get_by_text("9 m high")).to_be_visible()
    expect(page).to_have_title("The old oak – treestroke")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    box = page.locator(".preview-canvas").bounding_box()
    assert box is not None
    assert box["height"] > 400
    visitor.wait_for_rest()
    visitor.shot(f"shared-{request.node.callspec.id}")
    assert visitor.violations() == []
    with page.expect_download() as download:
        page.get_by_role("link", name="Download GLB").click()
    assert Path(download.value.path()).read_bytes()[:4] == b"glTF"
    assert download.value.suggested_filename == "The old oak.glb"
    page.get_by_text("Embed", exact=True).click()
    code = f'<iframe src="{shared.url}{path}?embed" width="800" height="600" title="The old oak"></iframe>'
    expect(page.get_by_label("Put this into a page of yours:")).to_have_value(code)
    visitor.shot(f"shared-embed-{request.node.callspec.id}")
    assert visitor.unexpected() == []


def test_a_link_stands_in_another_page_and_its_own_page_does_not(shared: Shared, page: Page) -> None:
    path = shared.link(download=False)["path"]
    sizes = "width=360 height=300"
    frames = "".join(f'<iframe src="{shared.url}{path}{end}" {sizes}></iframe>' for end in ("?embed", ""))
    with elsewhere(f"<title>elsewhere</title>{frames}") as address:
        page.goto(address)
    tree = page.frame_locator("iframe >> nth=0")
    expect(tree.locator("[data-state]")).to_have_attribute("data-state", "model")
    expect(tree.get_by_role("link", name="The old oak")).to_be_visible()
    assert tree.get_by_role("link", name="Download").count() == 0
    page.screenshot(path=SHOTS / "shared-embedded.png", timeout=PATIENCE_MS)
    assert page.frame_locator("iframe >> nth=1").locator(".share").count() == 0


def test_who_comes_too_late_is_told_so(shared: Shared, page: Page) -> None:
    link = shared.link()
    shared.revoke(link["id"])
    page.goto(shared.url + link["path"])
    expect(page.get_by_role("alert")).to_contain_text("This link has ended")
    page.goto(f"{shared.url}/s/{'A' * 22}")
    expect(page.get_by_role("alert")).to_contain_text("This link leads nowhere")
