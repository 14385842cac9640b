"""The web process: `python -m treestroke.api`, as `treestroke serve` starts it."""

import os
import socket
from functools import partial

import uvicorn

from treestroke.api.app import make_app
from treestroke.api.connections import ACCEPTED, Connection, max_connections
from treestroke.logs import start_logging
from treestroke.parent_process import stop_with_parent
from treestroke.settings import read_settings

LISTENER = "LISTEN_FD"
_GRACE_SECONDS = 5
_WAITING = 1024


class _Server(uvicorn.Server):
    """A server that takes connections a few at a time, and ends its event streams when it is told to stop."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen.

        What is taken from a listening socket at once would be its backlog; both are told apart here, so that many
        connections may wait to be taken, and are taken a few at a time.
        """
        await super().startup(sockets)
        for one in sockets or ():
            one.listen(_WAITING)

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
    most = max_connections(settings.tracers)
    config = uvicorn.Config(
        make_app(settings, places=most // 2),
        http=partial(Connection, most=most),  # type: ignore[arg-type]
        ws="none",
        backlog=ACCEPTED,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
        timeout_keep_alive=30,
    )
    _Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
