"""A real Caddy with deploy/Caddyfile, by TLS before a real hosted service."""

import re
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import httpx
import numpy as np
import pytest
from PIL import Image
from tests.faults.processes import wait_for
from tests.hosted import Hosted, hosting
from tests.postgres import PostgresServer

from treestroke.api.connections import HEAD_SECONDS
from treestroke.api.sign_ins import MOST_A_MINUTE
from treestroke.service.key_format import new_key

CADDYFILE = Path(__file__).parents[1] / "deploy" / "Caddyfile"
SECONDS = 120.0
"""Emergency exit of what is waited for."""


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


class Proxy:
    """Caddy on ports of 127.0.0.1, with a certificate for localhost of its own."""

    def __init__(self, folder: Path, service_port: int) -> None:
        self._folder, self.port, self.plain_port = folder, free_port(), free_port()
        here = f"admin off\n\tdefault_bind 127.0.0.1\n\thttp_port {self.plain_port}\n\thttps_port {self.port}"
        text = CADDYFILE.read_text().replace("admin off", here).replace("127.0.0.1:2080", f"127.0.0.1:{free_port()}")
        (folder / "Caddyfile").write_text(text)
        with (folder / "log").open("wb") as log:
            self._process = subprocess.Popen(
                [str(Path(sys.executable).with_name("caddy")), "run", "--config", str(folder / "Caddyfile")],
                env={"HOME": str(folder), "WEB_NAME": "127.0.0.1", "WEB_PORT": str(service_port)},
                stderr=log,
            )

    @property
    def authority(self) -> ssl.SSLContext:
        """What trusts its certificates, and no others."""
        (root,) = self._folder.rglob("root.crt")
        return ssl.create_default_context(cafile=str(root))

    def client(self) -> httpx.Client:
        """Return a client that reaches the service through it."""
        base = f"https:{'//'}localhost:{self.port}"
        return httpx.Client(base_url=base, verify=self.authority, timeout=SECONDS, trust_env=False)

    def answers(self) -> bool:
        """Tell whether the service answers through it."""
        assert self._process.poll() is None, (self._folder / "log").read_text()
        with suppress(httpx.HTTPError, ValueError, OSError), self.client() as client:
            return client.get("/livez").status_code == 200
        return False

    def end(self) -> None:
        """Stop it."""
        self._process.terminate()
        self._process.wait(SECONDS)


@pytest.fixture(scope="module")
def hosted(tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[Hosted]:
    with hosting(tmp_path_factory.mktemp("proxied") / "data", postgres.fresh_with_tables()) as service:
        yield service


@pytest.fixture(scope="module")
def proxy(tmp_path_factory: pytest.TempPathFactory, hosted: Hosted) -> Iterator[Proxy]:
    caddy = Proxy(tmp_path_factory.mktemp("caddy"), hosted.client.base_url.port or 0)
    try:
        wait_for(caddy.answers, SECONDS, "an answer through the proxy", every_s=0.2)
        yield caddy
    finally:
        caddy.end()


@pytest.fixture
def client(proxy: Proxy) -> Iterator[httpx.Client]:
    with proxy.client() as client:
        yield client


def as_key(hosted: Hosted) -> dict[str, str]:
    return {"Authorization": f"Bearer {hosted.key()}"}


def test_the_service_knows_that_it_is_asked_by_tls_whatever_a_client_says(client: httpx.Client) -> None:
    for said in ({}, {"X-Forwarded-Proto": "http"}):
        answer = client.get("/livez", headers=said)
        assert (answer.status_code, answer.headers["Strict-Transport-Security"]) == (200, "max-age=31536000")


def test_who_comes_without_tls_is_sent_to_it(proxy: Proxy) -> None:
    answer = httpx.get(f"http:{'//'}localhost:{proxy.plain_port}/v1/models", trust_env=False)
    assert answer.status_code == 308
    assert answer.headers["Location"].startswith(f"https:{'//'}localhost")


def test_the_name_that_was_asked_for_reaches_the_service(client: httpx.Client, hosted: Hosted) -> None:
    answer = client.post(
        "/v1/session", json={"key": hosted.key()}, headers={"Origin": str(client.base_url).rstrip("/")}
    )
    assert answer.status_code == 200, answer.text


def test_an_address_that_a_client_makes_up_is_not_believed(client: httpx.Client, hosted: Hosted) -> None:
    def sign_in(through: httpx.Client, address: str) -> int:
        headers = {"X-Forwarded-For": address}
        return through.post("/v1/session", json={"key": new_key()}, headers=headers).status_code

    through = [sign_in(client, f"203.0.113.{number}") for number in range(MOST_A_MINUTE + 1)]
    assert through == [401] * MOST_A_MINUTE + [429]
    # The service itself believes the proxy, so it is the proxy that replaces what clients say.
    assert sign_in(hosted.client, "203.0.113.200") == 401


def test_a_head_that_arrives_slowly_is_cut(proxy: Proxy) -> None:
    """It takes the 10 s that a head has."""
    with (
        socket.create_connection(("127.0.0.1", proxy.port), SECONDS) as connection,
        proxy.authority.wrap_socket(connection, server_hostname="localhost") as secured,
    ):
        secured.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX-Slow: ")
        secured.settimeout(SECONDS)
        assert b"200" not in secured.recv(1000)


def test_a_body_may_take_longer_than_a_head(client: httpx.Client, hosted: Hosted) -> None:
    """It sends 500 kB a second for longer than a head may take."""
    noise = np.random.default_rng(1).integers(0, 256, (1500, 1500, 3), np.uint8)
    Image.fromarray(noise).save(file := BytesIO(), "PNG")
    content = file.getvalue()
    piece = 50_000
    assert len(content) > 500_000 * HEAD_SECONDS * 1.2

    def slowly() -> Iterator[bytes]:
        for start in range(0, len(content), piece):
            time.sleep(piece / 500_000)
            yield content[start : start + piece]

    answer = client.post("/v1/photos", content=slowly(), headers={**as_key(hosted), "Content-Type": "image/png"})
    assert answer.status_code == 201, answer.text


def test_a_body_that_is_too_large_is_refused_by_the_service_which_says_why(
    client: httpx.Client, hosted: Hosted
) -> None:
    answer = client.post("/v1/photos", content=b"x" * 26_000_000, headers=as_key(hosted))
    assert (answer.status_code, answer.json()["code"]) == (413, "body_too_large")


def test_the_proxy_takes_larger_bodies_than_the_service() -> None:
    from treestroke.limits import MAX_CLIP_BYTES

    (megabytes,) = re.findall(r"max_size (\d+)MB", CADDYFILE.read_text())
    assert int(megabytes) * 10**6 > MAX_CLIP_BYTES * 1.1


def test_events_pass_as_they_happen(client: httpx.Client, hosted: Hosted) -> None:
    key = as_key(hosted)
    photo = CADDYFILE.parents[1] / "examples" / "sugar_maple_autumn.jpg"
    with photo.open("rb") as picture, photo.with_suffix(".strokes.json").open("rb") as strokes:
        asked = client.post("/v1/models", files={"photo": picture, "strokes": strokes}, headers=key)
    assert asked.status_code == 202, asked.text
    place = f"/v1/models/{asked.json()['id']}"
    with client.stream("GET", f"{place}/events", headers=key) as answer:
        lines = answer.iter_lines()
        assert "snapshot" in next(line for line in lines if line.startswith("event:"))
        with hosted.client.stream("POST", f"{place}/cancel", headers=key) as canceled:
            assert canceled.status_code == 200
        assert "canceled" in [line for line in lines if line.startswith("event:")][-1]
