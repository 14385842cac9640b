"""A service that teams share, in this process, without keys: a header of the tests says who asks."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import uvicorn
from fastapi import FastAPI, Request
from tests.faults.processes import wait_for

from treestroke.api.app import make_app
from treestroke.api.identity import admit
from treestroke.service.principals import Principal
from treestroke.settings import Settings

SECONDS = 120.0
"""Emergency exit of what is waited for."""


def as_person(team: str, name: str = "ann") -> dict[str, str]:
    """Give the headers of a person of a team."""
    return {"X-Person": f"{team} {name}"}


def _admit(request: Request) -> None:
    team, _, name = request.headers.get("x-person", "").partition(" ")
    request.state.principal = Principal(f"usr_{name}_{team}", team, name, "member") if team else None


@contextmanager
def shared_service(settings: Settings) -> Iterator[tuple[httpx.Client, FastAPI]]:
    """Run the service."""
    app = make_app(settings)
    app.dependency_overrides[admit] = _admit
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_config=None, ws="none", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        wait_for(lambda: server.started, SECONDS, "the service")
        port = server.servers[0].sockets[0].getsockname()[1]
        with httpx.Client(base_url=f"http:{'//'}127.0.0.1:{port}", timeout=SECONDS) as client:
            yield client, app
    finally:
        server.should_exit = True
        thread.join()
