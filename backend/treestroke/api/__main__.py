"""The web process: `python -m treestroke.api`, as `treestroke serve` starts it."""

import os
import socket

import uvicorn

from treestroke.api.app import make_app
from treestroke.lifeline import hold_lifeline
from treestroke.logs import start_logging
from treestroke.settings import read_settings

LISTENER = "LISTEN_FD"
_GRACE_SECONDS = 5


class _Server(uvicorn.Server):
    """A server that ends its event streams when it is told to stop, so that they do not hold it up."""

    def handle_exit(self, sig: int, frame: object) -> None:
        app = self.config.app
        if watcher := getattr(getattr(app, "state", None), "watcher", None):
            watcher.stop()
        super().handle_exit(sig, frame)  # type: ignore[arg-type]


def main() -> None:
    """Serve on the socket that the parent process listens on."""
    settings = read_settings()
    start_logging()
    hold_lifeline()
    listener = socket.socket(fileno=int(os.environ.pop(LISTENER)))
    config = uvicorn.Config(
        make_app(settings),
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
        timeout_keep_alive=30,
    )
    _Server(config).run(sockets=[listener])


if __name__ == "__main__":
    main()
