"""The queue: Celery, which carries the ids of jobs as hints. The jobs themselves are rows of the database."""

import json
import secrets
import time
from contextlib import suppress
from pathlib import Path
from queue import Empty
from typing import Any

from celery import Celery
from kombu.transport import filesystem

from treestroke.settings import Settings

TASK = "treestroke.grow"
_SOCKET_SECONDS = 2.0
"""A broker that does not answer within this is down."""
_POLL_SECONDS = 0.1
_GRACE_SECONDS = 10
"""After its own limit, which the job watches itself, a process that does not react is killed."""
_LOST_SECONDS = 0.5
"""After a process died, until its job is given back. No answer of it is waited for: what it did is in the database."""
DRAIN_SECONDS = 7.0
"""What a worker that is told to stop may still take for what it has begun."""


def make_queue(settings: Settings) -> Celery:
    """Make the Celery application: no result backend, messages acknowledged when they are taken.

    A lost message, a lost worker and a message that comes twice are all mended by the row's lease.
    """
    app = Celery("treestroke", set_as_current=False, fixups=[])
    app.conf.update(
        broker_url=settings.broker_url or "filesystem://localhost",
        broker_transport=None if settings.broker_url else _FolderTransport,
        broker_transport_options=_redis() if settings.broker_url else _folder(settings),
        broker_connection_timeout=_SOCKET_SECONDS,
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        broker_transport_polling_interval=_POLL_SECONDS,
        task_default_queue="treestroke",
        task_ignore_result=True,
        task_acks_late=False,
        task_time_limit=settings.model_seconds + _GRACE_SECONDS,
        worker_lost_wait=_LOST_SECONDS,
        worker_prefetch_multiplier=1,
        worker_concurrency=settings.workers or 1,
        worker_hijack_root_logger=False,
        worker_redirect_stdouts=False,
        worker_enable_remote_control=False,
        worker_send_task_events=False,
        accept_content=["json"],
    )
    return app


def send_job_message(app: Celery, model: str) -> None:
    """Tell the workers that a job waits.

    Raises
    ------
    kombu.exceptions.OperationalError, OSError
        The broker does not take it.
    """
    app.send_task(TASK, args=[model], retry=False, ignore_result=True)


class _FolderChannel(filesystem.Channel):
    """Messages as files that are seen whole or not at all; kombu's own are seen while they are being written.

    One that is no message all the same is thrown away: it would end the worker that reads it.
    """

    def _put(self, queue: str, payload: Any, **_: Any) -> None:  # type: ignore[override]
        name = f"{time.time_ns():020d}-{secrets.token_hex(8)}"
        begun = Path(self.data_folder_out) / f"{name}.part"
        begun.parent.mkdir(mode=0o700, parents=True, exist_ok=True)  # somebody may have removed it
        try:
            begun.write_text(json.dumps(payload))
            begun.rename(begun.with_name(f"{name}.{queue}.msg"))
        except OSError:
            begun.unlink(missing_ok=True)
            raise

    def _size(self, queue: str) -> int:
        return len(self._messages(queue))

    def _messages(self, queue: str) -> list[Path]:
        """List the messages in their order; none where the folder is gone."""
        return sorted(Path(self.data_folder_in).glob(f"*.{queue}.msg"))

    def _get(self, queue: str) -> Any:  # type: ignore[override]
        for path in self._messages(queue):
            # Whoever removes it has it.
            with suppress(FileNotFoundError, ValueError):
                content = path.read_bytes()
                path.unlink()
                message = json.loads(content)
                if isinstance(message, dict) and message.keys() >= {"body", "headers", "properties"}:
                    return message
        raise Empty


class _FolderTransport(filesystem.Transport):
    """A folder that Celery's event loop looks into.

    Only with its event loop has a pool a line of its own to each child. Otherwise the children share one, whose lock a
    child that is killed at the wrong moment takes with it: nothing is ever grown again.
    """

    Channel = _FolderChannel
    implements = filesystem.Transport.implements.extend(asynchronous=True)

    def register_with_event_loop(self, connection: Any, loop: Any) -> None:
        """Take a message now and then."""
        loop.call_repeatedly(_POLL_SECONDS, self._look, connection)

    def _look(self, connection: Any) -> None:
        with suppress(TimeoutError):  # there is none
            self.drain_events(connection, timeout=0)


def _redis() -> dict[str, Any]:
    return {
        "socket_timeout": _SOCKET_SECONDS,
        "socket_connect_timeout": _SOCKET_SECONDS,
        "socket_keepalive": True,
        "health_check_interval": 5,
        "polling_interval": _POLL_SECONDS,
    }


def _folder(settings: Settings) -> dict[str, Any]:
    queue = settings.folder / "queue"
    for folder in (queue / "messages", queue / "control"):
        folder.mkdir(parents=True, exist_ok=True)
    return {
        "data_folder_in": str(queue / "messages"),
        "data_folder_out": str(queue / "messages"),
        "control_folder": str(queue / "control"),
        "store_processed": False,
        "polling_interval": _POLL_SECONDS,
    }
