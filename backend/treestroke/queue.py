"""The queue: Celery messages that say that a job waits. The jobs themselves are rows of the database."""

import json
import math
import secrets
import ssl
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from queue import Empty
from typing import Any

from celery import Celery
from kombu.exceptions import OperationalError
from kombu.transport import TRANSPORT_ALIASES, filesystem, redis, virtual
from redis.exceptions import RedisError

from treestroke.settings import Settings

WORK = "treestroke.work"
"""The task of workers: doing the job that is next."""
EARLIER_TASKS = "treestroke.grow", "treestroke.solve"
"""Tasks by which earlier versions named a job; they too say that one waits."""
_QUEUE = "treestroke"
_SOCKET_SECONDS = 2.0
"""A broker that does not respond within this time is down."""
_VERIFIED = {"ssl_cert_reqs": ssl.CERT_REQUIRED}
_POLL_SECONDS = 0.1
_GRACE_SECONDS = 10
"""Time after a job's own limit, which it checks itself, at which a process that does not react is killed."""
_LOST_SECONDS = 0.5
"""Time from a process's death until its job is taken back; its results are in the database, not in messages."""
DRAIN_SECONDS = 7.0
"""Time that a worker which is told to stop has for its running jobs."""
_DEAF_LOOKS = 23
"""A worker that has nothing to do takes a message at once, or after the 30 seconds at most in which it notices that its
broker is back; one that has taken none after so many looks never will."""


def make_queue(settings: Settings) -> Celery:
    """Return the Celery application: no result backend, messages acknowledged when they are received.

    The lease in the job's row covers lost messages, lost workers and messages that arrive twice.
    """
    app = Celery("treestroke", set_as_current=False, fixups=[])
    app.conf.update(
        broker_url=settings.broker_url or "filesystem://localhost",
        broker_transport=None if settings.broker_url else _FolderTransport,
        broker_use_ssl=_VERIFIED if settings.broker_url.startswith("rediss:") else None,
        broker_transport_options=_redis() if settings.broker_url else _folder(settings),
        broker_connection_timeout=_SOCKET_SECONDS,
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        broker_transport_polling_interval=_POLL_SECONDS,
        task_default_queue=_QUEUE,
        task_ignore_result=True,
        task_acks_late=False,
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


def hard_limit(seconds: float) -> int:
    """Return the seconds after which a process is killed whose job has a limit of so many ``seconds``."""
    return math.ceil(seconds + _GRACE_SECONDS)


class Hints:
    """Messages that say that a job waits; they name none."""

    def __init__(self, app: Celery) -> None:
        self._app = app

    def waiting(self) -> int:
        """Return how many messages no worker has taken.

        Raises
        ------
        kombu.exceptions.OperationalError, redis.exceptions.RedisError, OSError
            The broker does not say.
        """
        with self._app.connection_or_acquire() as connection:
            return int(connection.default_channel.queue_declare(_QUEUE).message_count)

    def send(self) -> None:
        """Send one.

        Raises
        ------
        kombu.exceptions.OperationalError, OSError
            The broker does not accept it.
        """
        self._app.send_task(WORK, retry=False, ignore_result=True)


class Hearing:
    """Tells whether a worker still takes messages: a consumer may hang for ever after its broker was away."""

    def __init__(self, hints: Hints) -> None:
        self._hints = hints
        self._missed = 0
        """Looks in a row that found messages waiting; not seconds, for the whole process may have stood still."""

    def heard(self) -> None:
        """Note that the worker has taken a message."""
        self._missed = 0

    def is_deaf(self, idle: Callable[[], bool]) -> bool:
        """Look once, and tell whether messages have waited for long while the worker was ``idle`` and took none."""
        self._missed = self._missed + 1 if self._some_wait() and idle() else 0
        return self._missed >= _DEAF_LOOKS

    def _some_wait(self) -> bool:
        try:
            return self._hints.waiting() > 0
        except (OperationalError, RedisError, OSError):
            return False  # nobody can take a message from a broker that is away


class _RedisQoS(redis.QoS):
    """Forgets a message that was taken, even where Redis cannot be told so because it is away.

    A worker that may have one message at a time would have it for ever: it would neither ask for another one nor
    notice that its connection is lost. That the message comes back later does no harm.
    """

    def ack(self, delivery_tag: str) -> None:
        try:
            super().ack(delivery_tag)
        except (RedisError, OSError):
            virtual.QoS.ack(self, delivery_tag)
            raise


class _RedisChannel(redis.Channel):
    QoS = _RedisQoS


class RedisTransport(redis.Transport):
    """Redis, as kombu speaks with it but for what is above; its URLs lead here."""

    Channel = _RedisChannel


TRANSPORT_ALIASES.update(dict.fromkeys(("redis", "rediss"), f"{__name__}:{RedisTransport.__name__}"))


class _FolderChannel(filesystem.Channel):
    """Messages as files that become visible when they are complete; kombu's are visible while they are written.

    A file that is not a message is removed: it would end the worker that reads it.
    """

    def _queue_bind(self, *arguments: Any) -> None:
        self.control_folder.mkdir(mode=0o700, parents=True, exist_ok=True)  # kombu's own mkdir needs the parent folder
        super()._queue_bind(*arguments)

    def _put(self, queue: str, payload: Any, **_: Any) -> None:  # type: ignore[override]
        name = f"{time.time_ns():020d}-{secrets.token_hex(8)}"
        unfinished = Path(self.data_folder_out) / f"{name}.part"
        unfinished.parent.mkdir(mode=0o700, parents=True, exist_ok=True)  # it may have been removed
        try:
            unfinished.write_text(json.dumps(payload))
            unfinished.rename(unfinished.with_name(f"{name}.{queue}.msg"))
        except OSError:
            unfinished.unlink(missing_ok=True)
            raise

    def _size(self, queue: str) -> int:
        return len(self._messages(queue))

    def _messages(self, queue: str) -> list[Path]:
        """Return the messages in their order; none if the folder is missing."""
        return sorted(Path(self.data_folder_in).glob(f"*.{queue}.msg"))

    def _get(self, queue: str) -> Any:  # type: ignore[override]
        for path in self._messages(queue):
            # Of several processes that read it, the one that removes the file receives the message.
            with suppress(FileNotFoundError, ValueError):
                content = path.read_bytes()
                path.unlink()
                message = json.loads(content)
                if isinstance(message, dict) and message.keys() >= {"body", "headers", "properties"}:
                    return message
        raise Empty


class _FolderTransport(filesystem.Transport):
    """A folder that Celery's event loop polls.

    Only with the event loop does Celery's pool have a pipe to each child. Otherwise all children share one, and a child
    that is killed while it holds the pipe's lock blocks the others for ever.
    """

    Channel = _FolderChannel
    implements = filesystem.Transport.implements.extend(asynchronous=True)

    def register_with_event_loop(self, connection: Any, loop: Any) -> None:
        """Poll for messages at intervals."""
        loop.call_repeatedly(_POLL_SECONDS, self._poll, connection)

    def _poll(self, connection: Any) -> None:
        with suppress(TimeoutError):  # no message
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
