"""What a service without a terminal writes to stderr."""

import io
import json
import logging
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

from tests.faults.processes import wait_for
from tests.running import BACKEND, serving

from treestroke.client import Client
from treestroke.logs import ThinnedHandler

DATA = Path(__file__).parent / "data"


def test_logs_are_json_and_every_line_of_a_job_names_it(tmp_path: Path) -> None:
    with serving(tmp_path / "data", tracers=1) as address, Client(address) as client:
        photo = client.upload(DATA / "elm_house.jpg")
        model = client.wait(client.grow(photo, DATA / "elm_house.strokes.json", {"iterations": 5}), timeout=600)
    lines = [json.loads(line) for line in (tmp_path / "data.log").read_text().splitlines()]
    assert all({"event", "level", "timestamp"} <= line.keys() for line in lines)
    about = [line for line in lines if line["event"].startswith("job_")]
    assert [line["event"] for line in about] == ["job_started", "job_succeeded"]
    assert {(line["job"], line["attempt"]) for line in about} == {(model.id, 1)}
    assert [line for line in lines if line["level"] not in ("info", "warning")] == []


def logged(program: str) -> list[dict[str, Any]]:
    """Run a program that logs, as a process of the service does; give its lines."""
    code = f"import logging, structlog\nfrom treestroke.logs import start_logging\nstart_logging()\n{program}"
    environment = {"PYTHONPATH": str(BACKEND)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stderr.splitlines()]


def test_a_line_that_repeats_is_written_once_and_then_told_with_its_number() -> None:
    lines = logged(
        "log = structlog.get_logger()\n"
        "for _ in range(1000):\n"
        "    log.error('storage_failed', error='no room')\n"
        "    logging.getLogger('asyncio').error('socket.accept() out of system resource')\n"
        "    log.error('storage_failed', error='no such file')\n"
    )
    told = [(line["event"][:14], line.get("error"), line.get("repeated")) for line in lines]
    kinds = [("storage_failed", "no room"), ("socket.accept(", None), ("storage_failed", "no such file")]
    assert told == [(*kind, repeated) for repeated in (None, 999) for kind in kinds]


def test_lines_about_different_jobs_are_different_lines() -> None:
    lines = logged(
        "log = structlog.get_logger()\n"
        "for job in range(50):\n"
        "    with structlog.contextvars.bound_contextvars(job=job):\n"
        "        log.info('job_started')\n"
    )
    assert [line["job"] for line in lines] == list(range(50))


def test_requests_that_are_no_http_are_told_once_with_who_sent_them(tmp_path: Path) -> None:
    with serving(tmp_path / "data", workers=0, tracers=1) as address:
        host, port = address.removeprefix("http:" + "//").split(":")
        for _ in range(5):
            with socket.create_connection((host, int(port)), timeout=60) as line:
                line.sendall(b"nonsense\r\n\r\n")
                assert line.recv(100).startswith(b"HTTP/1.1 400 ")
    lines = [json.loads(line) for line in (tmp_path / "data.log").read_text().splitlines()]
    about = [line for line in lines if "nvalid" in line["event"]]
    assert {(line["event"], line["peer"]) for line in about} == {("request_invalid", "127.0.0.1")}
    assert len(about) <= 2


def test_every_error_s_first_trace_is_kept_and_no_repeated_one() -> None:
    lines = logged(
        "log = structlog.get_logger()\n"
        "for number in range(100):\n"
        "    try:\n"
        "        [][number % 2] if number % 2 else 1 / 0\n"
        "    except Exception as error:\n"
        "        log.exception('request_failed')\n"
        "        logging.getLogger('uvicorn.error').error('broke', exc_info=error)\n"
    )
    assert len(lines) == 8
    assert sum("ZeroDivisionError" in line["exception"] for line in lines[:4]) == 2
    assert sum("IndexError" in line["exception"] for line in lines[:4]) == 2
    assert [(line["repeated"], "exception" in line) for line in lines[4:]] == [(49, False)] * 4


def test_what_repeats_is_told_when_the_interval_ends_and_is_written_again_after_it() -> None:
    stream, log = io.StringIO(), logging.Logger("repeating")
    handler = ThinnedHandler(stream, seconds=1.0)
    handler.setFormatter(logging.Formatter("%(message)s"))
    log.addHandler(handler)
    for number in range(2):
        for _ in range(5):
            log.error("again")
        wait_for(lambda lines=2 * number + 2: stream.getvalue().count("again") == lines, 60, "the repeated line")
