"""Messages that come twice, too late, torn, or from somebody else: the queue's messages are hints, and only that."""

import json
import shutil
import time
from pathlib import Path

import pytest
from celery import Celery
from redis import Redis
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for

from treestroke.queue import EARLIER_TASKS, WORK, Hints, make_queue
from treestroke.settings import Settings


def hints_of(service: Service, broker_url: str) -> tuple[Hints, Celery]:
    queue = make_queue(Settings(data=service.data, broker_url=broker_url))
    return Hints(queue), queue


def inject(service: Service, broker_url: str, message: bytes) -> None:
    """Put bytes where the worker looks for messages."""
    if broker_url:
        with Redis.from_url(broker_url) as redis:
            redis.lpush("treestroke", message)
    else:
        (service.data / "queue" / "messages" / f"{time.time_ns()}.treestroke.msg").write_bytes(message)


def test_hints_that_come_twice_or_too_late_or_name_a_job_as_they_once_did_change_nothing(
    service: Service, broker_url: str
) -> None:
    hints, queue = hints_of(service, broker_url)
    ids = service.ask_for(2, "instant")
    for id in (*ids, *ids, "mdl_nobody"):
        hints.send()
        queue.send_task(EARLIER_TASKS[0], args=[id], retry=False)
    before = service.finish(ids)
    for _ in ids:
        hints.send()
    wait_for(lambda: hints.waiting() == 0, PATIENCE_SECONDS, "an empty queue")
    service.finish([service.ask("instant")])
    assert [(row["status"], row["attempt"]) for row in before] == [("succeeded", 1)] * 2
    assert [service.row(id) for id in ids] == before


def test_a_worker_survives_messages_that_are_not_for_it(service: Service, broker_url: str) -> None:
    workers = [one.pid for one in service.workers()]
    _, queue = hints_of(service, broker_url)
    queue.send_task("treestroke.of_another_version", args=["mdl_1"], retry=False)
    queue.send_task(WORK, args=["mdl_1", {"more": "than we know"}], kwargs={"new": 1}, retry=False)
    for name in EARLIER_TASKS:
        queue.send_task(name, args=[], retry=False)
        queue.send_task(name, args=[["not", "an", "id"]], retry=False)
    inject(service, broker_url, old_form("mdl_1"))
    (row,) = service.finish([service.ask("instant")])
    assert (row["status"], row["attempt"]) == ("succeeded", 1)
    assert [one.pid for one in service.workers()] == workers


def test_a_worker_survives_files_that_are_no_messages(service: Service, broker_url: str) -> None:
    if broker_url:
        pytest.skip("nobody but the service writes to its Redis; a crash between open and write leaves torn files only")
    workers = [one.pid for one in service.workers()]
    for garbage in (b"", b"{", b"[]", b"\xff\xfe", b'{"body": "", "headers": {}, "properties"'):
        inject(service, broker_url, garbage)
    (row,) = service.finish([service.ask("instant")])
    assert row["status"] == "succeeded"
    assert [one.pid for one in service.workers()] == workers


def old_form(id: str) -> bytes:
    """Make a message as the first protocol of Celery had it, all in the body."""
    body = json.dumps({"task": EARLIER_TASKS[0], "id": "1", "args": [id], "kwargs": {}})
    properties = {
        "delivery_tag": "1",
        "delivery_mode": 2,
        "body_encoding": None,
        "delivery_info": {"exchange": "", "routing_key": "treestroke"},
    }
    return json.dumps(
        {
            "body": body,
            "headers": {},
            "content-type": "application/json",
            "content-encoding": "utf-8",
            "properties": properties,
        }
    ).encode()


@pytest.mark.parametrize("sent", [0, 1])
def test_a_queue_whose_folder_is_removed_takes_messages(sent: int, tmp_path: Path) -> None:
    hints = Hints(make_queue(Settings(data=tmp_path)))
    for _ in range(sent):
        hints.send()
    shutil.rmtree(tmp_path / "queue")
    assert hints.waiting() == 0
    hints.send()
    assert len(list((tmp_path / "queue" / "messages").glob("*.msg"))) == 1


def test_a_message_that_is_being_written_is_not_seen(tmp_path: Path) -> None:
    queue = make_queue(Settings(data=tmp_path))
    Hints(queue).send()
    (message,) = (tmp_path / "queue" / "messages").iterdir()
    begun = message.with_suffix(".part")
    message.rename(begun)
    with queue.connection_for_read() as connection, connection.SimpleQueue("treestroke") as waiting:
        assert len(waiting) == 0
        begun.rename(message)
        taken = waiting.get(block=False)
        assert taken.headers["task"] == WORK
        taken.ack()
    assert list(message.parent.iterdir()) == []
