"""Logs: one line for each event, plain on a terminal and JSON elsewhere; repeated lines are counted."""

import logging
import sys
import threading
import time
from collections import deque
from collections.abc import Hashable
from typing import TextIO

import structlog

_REPEAT_SECONDS = 10.0
"""Time during which repetitions of a line are counted instead of written."""
_MAX_LINES = 500
REQUEST = "request_id"
"""By which name lines that are written while a request is handled have its id."""
_MAX_REQUESTS = 100
"""Ids of requests that the summary of a repeated line names, the last."""


class _Line:
    """A line that was written, and its repetitions since then."""

    def __init__(self, written: float) -> None:
        self.written, self.repeated = written, 0
        self.last: logging.LogRecord | None = None
        self.requests: deque[str] = deque(maxlen=_MAX_REQUESTS)


class ThinnedHandler(logging.StreamHandler[TextIO]):
    """Writes new lines at once; of repetitions within some seconds only the last, with their number."""

    def __init__(self, stream: TextIO, seconds: float = _REPEAT_SECONDS) -> None:
        super().__init__(stream)
        self._seconds = seconds
        self._lines: dict[Hashable, _Line] = {}
        self._timer: threading.Timer | None = None

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, or count it as a repetition."""
        key, now = _content(record), time.monotonic()
        line = self._lines.get(key)
        if line is None or (not line.repeated and now - line.written >= self._seconds):
            if len(self._lines) >= _MAX_LINES:
                self._lines = {key: line for key, line in self._lines.items() if line.repeated}
            self._lines[key] = _Line(now)
            super().emit(record)
            return
        line.repeated, line.last = line.repeated + 1, record
        if request := structlog.contextvars.get_contextvars().get(REQUEST):
            line.requests.append(request)
        if self._timer is None or not self._timer.is_alive():  # a forked process has the timer, but not its thread
            self._timer = threading.Timer(self._seconds, self._write_repeated)
            self._timer.daemon = True
            self._timer.start()

    def close(self) -> None:
        """Write the counted repetitions, then close."""
        self._write_repeated()
        super().close()

    def _write_repeated(self) -> None:
        with self.lock:  # type: ignore[union-attr]
            lines, self._lines, self._timer = self._lines, {}, None
            for line in lines.values():
                if line.last is not None:
                    super().emit(_summary(line.last, line))


def _content(record: logging.LogRecord) -> Hashable:
    """Return what a line says, without its time and request: lines about different jobs are different."""
    values = record.msg if isinstance(record.msg, dict) else {"event": record.getMessage()}
    error = record.exc_info or values.get("exc_info")
    error = sys.exception() if error is True else error[1] if isinstance(error, tuple) else error
    content = {**values, "timestamp": None, REQUEST: None, "exc_info": repr(error)}
    return record.name, record.levelno, repr(sorted(content.items()))


def _summary(record: logging.LogRecord, line: _Line) -> logging.LogRecord:
    """Return a record that stands for all of a line; the traceback was written with the first of them."""
    record.counted = {"repeated": line.repeated, **({"requests": [*line.requests]} if line.requests else {})}
    record.exc_info = record.exc_text = None
    if isinstance(record.msg, dict):
        record.msg = {name: value for name, value in record.msg.items() if name not in ("exc_info", REQUEST)}
    return record


def _add_counted(_logger: object, _name: str, event: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Add what a summary tells of the lines that it stands for."""
    return {**event, **getattr(event["_record"], "counted", {})}


def _is_needed(record: logging.LogRecord) -> bool:
    """Drop uvicorn's line on an invalid request: the service's own line has the sender."""
    return record.msg != "Invalid HTTP request received."


def start_logging() -> None:
    """Set up structured logging to stderr, for the libraries' lines too."""
    on_terminal = sys.stderr.isatty()
    shared: list[structlog.typing.Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.processors.add_log_level,
        structlog.processors.TimeStamper(fmt="%H:%M:%S" if on_terminal else "iso", utc=not on_terminal),
        structlog.processors.StackInfoRenderer(),
    ]
    renderers: list[structlog.typing.Processor] = (
        [structlog.dev.ConsoleRenderer(pad_event_to=0, pad_level=False)]
        if on_terminal
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
            processors=[_add_counted, structlog.stdlib.ProcessorFormatter.remove_processors_meta, *renderers],
        )
    )
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(logging.INFO)
    for noisy in ("alembic", "celery", "kombu", "uvicorn", "httpx", "botocore"):
        logging.getLogger(noisy).setLevel(logging.WARNING)
    logging.getLogger("uvicorn.error").addFilter(_is_needed)
