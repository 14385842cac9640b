"""Logs: one line an event, JSON where nobody looks and plain where somebody does; a line that repeats is told once."""

import logging
import sys
import threading
import time
from collections.abc import Hashable
from typing import TextIO

import structlog

_SECONDS = 10.0
"""For so long what repeats a line is counted instead of written."""
_MANY = 500


class _Line:
    """A line that was written, and what repeated it since."""

    def __init__(self, written: float) -> None:
        self.written, self.repeated = written, 0
        self.last: logging.LogRecord | None = None


class ThinnedHandler(logging.StreamHandler[TextIO]):
    """Writes a line that is new at once; of those that repeat one within some seconds the last alone, with how many."""

    def __init__(self, stream: TextIO, seconds: float = _SECONDS) -> None:
        super().__init__(stream)
        self._seconds = seconds
        self._lines: dict[Hashable, _Line] = {}
        self._timer: threading.Timer | None = None

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or count it."""
        key, now = _content(record), time.monotonic()
        line = self._lines.get(key)
        if line is None or (not line.repeated and now - line.written >= self._seconds):
            if len(self._lines) >= _MANY:
                self._lines = {one: line for one, line in self._lines.items() if line.repeated}
            self._lines[key] = _Line(now)
            super().emit(record)
            return
        line.repeated, line.last = line.repeated + 1, record
        if self._timer is None or not self._timer.is_alive():  # a fork has the object, but not its thread
            self._timer = threading.Timer(self._seconds, self._tell_repeated)
            self._timer.daemon = True
            self._timer.start()

    def close(self) -> None:
        """Tell what was counted."""
        self._tell_repeated()
        super().close()

    def _tell_repeated(self) -> None:
        with self.lock:  # type: ignore[union-attr]
            told, self._lines, self._timer = self._lines, {}, None
            for line in told.values():
                if line.last is not None:
                    super().emit(_of_many(line.last, line.repeated))


def _content(record: logging.LogRecord) -> Hashable:
    """Give all that a line says but its time: lines about different jobs are different."""
    said = record.msg if isinstance(record.msg, dict) else {"event": record.getMessage()}
    error = record.exc_info or said.get("exc_info")
    error = sys.exception() if error is True else error[1] if isinstance(error, tuple) else error
    content = {**said, "timestamp": None, "exc_info": repr(error)}
    return record.name, record.levelno, repr(sorted(content.items()))


def _of_many(record: logging.LogRecord, repeated: int) -> logging.LogRecord:
    """Let a record stand for many; the trace is with the first of them."""
    record.repeated = repeated
    record.exc_info = record.exc_text = None
    if isinstance(record.msg, dict):
        record.msg = {name: value for name, value in record.msg.items() if name != "exc_info"}
    return record


def _add_repeated(_logger: object, _name: str, event: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Say how many lines one stands for, where it is more than one."""
    repeated = getattr(event["_record"], "repeated", 0)
    return {**event, "repeated": repeated} if repeated else event


def _is_news(record: logging.LogRecord) -> bool:
    """Leave out what uvicorn says of a request that is no HTTP: the service's own line names who sent it."""
    return record.msg != "Invalid HTTP request received."


def start_logging() -> None:
    """Write structured lines to stderr; the libraries' own lines take the same form."""
    watched = sys.stderr.isatty()
    shared: list[structlog.typing.Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.processors.add_log_level,
        structlog.processors.TimeStamper(fmt="%H:%M:%S" if watched else "iso", utc=not watched),
        structlog.processors.StackInfoRenderer(),
    ]
    shape: list[structlog.typing.Processor] = (
        [structlog.dev.ConsoleRenderer(pad_event_to=0, pad_level=False)]
        if watched
        else [structlog.processors.format_exc_info, structlog.processors.JSONRenderer()]
    )
    structlog.configure(
        processors=[*shared, structlog.stdlib.ProcessorFormatter.wrap_for_formatter],
        logger_factory=structlog.stdlib.LoggerFactory(),
        wrapper_class=structlog.stdlib.BoundLogger,
        cache_logger_on_first_use=True,
    )
    handler = ThinnedHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared,
            processors=[_add_repeated, structlog.stdlib.ProcessorFormatter.remove_processors_meta, *shape],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(logging.INFO)
    for noisy in ("alembic", "celery", "kombu", "uvicorn", "httpx"):
        logging.getLogger(noisy).setLevel(logging.WARNING)
    logging.getLogger("uvicorn.error").addFilter(_is_news)
