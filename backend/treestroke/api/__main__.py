"""The web process: `python -m treestroke.api`, as `treestroke serve` starts it."""

import os
import socket
from functools import partial

import uvicorn

from treestroke.api.app import make_app
from treestroke.api.connections import ACCEPTED_AT_ONCE, Connection, max_connections
from treestroke.logs import start_logging
from treestroke.parent_process import LISTENER, stop_with_parent
from treestroke.settings import read_settings

_GRACE_SECONDS = 5
_KEEP_ALIVE_SECONDS = 30
_BACKLOG = 1024
"""Connections that may wait in the listening socket."""


class _Server(uvicorn.Server):
    """A server that accepts a few connections at a time and ends its event streams when it is told to stop."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to listen.

        uvicorn's ``backlog`` sets two numbers: how many connections may wait, and how many asyncio accepts at once.
        The first is set again here, so that many may wait and few are accepted at once.
        """
        await super().startup(sockets)
        for listener in sockets or ():
            listener.listen(_BACKLOG)

    def handle_exit(self, sig: int, frame: object) -> None:
        app = self.config.app
        if watcher := getattr(getattr(app, "state", None), "watcher", None):
            watcher.stop()
        super().handle_exit(sig, frame)  # type: ignore[arg-type]


def main() -> None:
    """Serve on the socket that the parent process listens on."""
    settings = read_settings()
    start_logging()
    stop_with_parent()
    listener = socket.socket(fileno=int(os.environ.pop(LISTENER)))
    limit = max_connections(settings.tracers + 1)  # one traces captures
    config = uvicorn.Config(
        make_app(settings, places=limit // 2),
        http=partial(Connection, limit=limit),  # type: ignore[arg-type]
        ws="none",
        backlog=ACCEPTED_AT_ONCE,
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,  # the application reads them itself, since it has to know who sent them
        timeout_graceful_shutdown=_GRACE_SECONDS,
        timeout_keep_alive=_KEEP_ALIVE_SECONDS,
    )
    _Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
