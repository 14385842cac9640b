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

from treestroke.queue import GROW, make_queue, send_job_message
from treestroke.settings import Settings


def queue_of(service: Service, broker_url: str) -> Celery:
    return make_queue(Settings(data=service.data, broker_url=broker_url))


def inject(service: Service, broker_url: str, message: bytes) -> None:
    """Put bytes where the worker looks for messages."""
    if broker_url:
        with Redis.from_url(broker_url) as redis:
            redis.lpush("treestroke", message)
    else:
        (service.data / "queue" / "messages" / f"{time.time_ns()}.treestroke.msg").write_bytes(message)


def test_a_hint_that_comes_twice_or_too_late_or_for_nobody_changes_nothing(service: Service, broker_url: str) -> None:
    queue = queue_of(service, broker_url)
    ids = service.ask_for(2, "instant")
    for id in (*ids, *ids, "mdl_nobody"):
        send_job_message(queue, GROW, id)
    before = service.finish(ids)
    ignored = len(service.logged("job_message_ignored"))
    for id in ids:
        send_job_message(queue, GROW, id)
    wait_for(
        lambda: len(service.logged("job_message_ignored")) >= ignored + 2,
        PATIENCE_SECONDS,
        "two more messages that are ignored",
    )
    assert [(row["status"], row["attempt"]) for row in before] == [("succeeded", 1)] * 2
    assert [service.row(id) for id in ids] == before


def test_a_worker_survives_messages_that_are_not_for_it(service: Service, broker_url: str) -> None:
    workers = [one.pid for one in service.workers()]
    queue = queue_of(service, broker_url)
    queue.send_task("treestroke.of_another_version", args=["mdl_1"], retry=False)
    queue.send_task(GROW, args=["mdl_1", {"more": "than we know"}], kwargs={"new": 1}, retry=False)
    queue.send_task(GROW, args=[], retry=False)
    queue.send_task(GROW, args=[["not", "an", "id"]], retry=False)
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
    body = json.dumps({"task": GROW, "id": "1", "args": [id], "kwargs": {}})
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
    queue = make_queue(Settings(data=tmp_path))
    for _ in range(sent):
        send_job_message(queue, GROW, "mdl_1")
    shutil.rmtree(tmp_path / "queue")
    send_job_message(queue, GROW, "mdl_2")
    assert len(list((tmp_path / "queue" / "messages").glob("*.msg"))) == 1


def test_a_message_that_is_being_written_is_not_seen(tmp_path: Path) -> None:
    queue = make_queue(Settings(data=tmp_path))
    send_job_message(queue, GROW, "mdl_1")
    (message,) = (tmp_path / "queue" / "messages").iterdir()
    begun = message.with_suffix(".part")
    message.rename(begun)
    with queue.connection_for_read() as connection, connection.SimpleQueue("treestroke") as waiting:
        assert len(waiting) == 0
        begun.rename(message)
        taken = waiting.get(block=False)
        assert taken.payload[0] == ["mdl_1"]
        taken.ack()
    assert list(message.parent.iterdir()) == []
