"""A hosted service that runs: on a Postgres, behind a proxy that speaks TLS, with teams, members and keys."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.cookies import SimpleCookie
from pathlib import Path
from typing import Any

import httpx
from tests.running import serving

from treestroke.account_schemas import KeyScope, Role
from treestroke.api.identity import COOKIE
from treestroke.service.team_setup import Person, add_key
from treestroke.store.database import Database
from treestroke.wire_accounts import KeyRequest

SECRET = "a secret of the tests, long enough to digest keys by"
HOST = "trees.example"
ORIGIN = f"https:{'//'}{HOST}"
PROXIED = {"Host": HOST, "X-Forwarded-Proto": "https", "X-Forwarded-For": "203.0.113.7"}
"""What a proxy adds to a request that came by TLS."""
BOTH: tuple[KeyScope, ...] = ("trees", "team")


@dataclass(frozen=True)
class Hosted:
    """A hosted service: a client of it without a key, and its database."""

    client: httpx.Client
    database: Database

    def key(self, role: Role = "owner", team: str = "Oaks", scopes: tuple[KeyScope, ...] = BOTH, **more: Any) -> str:
        """Make a key of a team's member who has this role, and is called by it."""
        wanted = KeyRequest(name="test", scopes=list(scopes), **more)
        return add_key(self.database, SECRET, Person(team, role, role), wanted).key

    def ask(self, key: str, method: str, path: str, **request: Any) -> httpx.Response:
        """Ask with a key, as a program does."""
        return self.client.request(method, path, headers={"Authorization": f"Bearer {key}"}, **request)

    def sign_in(self, key: str) -> dict[str, str]:
        """Sign in by a key; return what a browser sends with each request of the service's own page."""
        return page_headers(self.client.post("/v1/session", json={"key": key}))


def page_headers(signed_in: httpx.Response) -> dict[str, str]:
    """Return what a browser sends once it was given its session's cookie."""
    assert signed_in.status_code == 200, signed_in.text
    return {"Origin": ORIGIN, "Cookie": f"{COOKIE}={SimpleCookie(signed_in.headers['Set-Cookie'])[COOKIE].value}"}


@contextmanager
def hosting(folder: Path, database_url: str, **more: object) -> Iterator[Hosted]:
    """Run a hosted service on a database that has its tables, with ``more`` settings."""
    settings = {"database_url": database_url, "secret": SECRET, "hosts": HOST, "proxies": "127.0.0.1", **more}
    database = Database(folder, database_url)
    with (
        serving(folder, workers=0, tracers=1, **settings) as url,
        httpx.Client(base_url=url, headers=PROXIED, timeout=60) as client,
    ):
        yield Hosted(client, database)
    database.close()
