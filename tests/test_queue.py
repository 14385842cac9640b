import ssl

import pytest
from kombu.exceptions import OperationalError

from treestroke import queue
from treestroke.queue import Hearing, Hints, make_queue
from treestroke.settings import read_settings

LOOKS = 4


class Broker(Hints):
    """A broker with so many messages; None: it is away."""

    def __init__(self, messages: int | None) -> None:
        self.messages = messages

    def waiting(self) -> int:
        if self.messages is None:
            raise OperationalError
        return self.messages


@pytest.fixture(autouse=True)
def _few_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(queue, "_DEAF_LOOKS", LOOKS)


def looks(hearing: Hearing, number: int, idle: bool = True) -> list[bool]:
    return [hearing.is_deaf(lambda: idle) for _ in range(number)]


def test_a_worker_that_leaves_messages_waiting_though_it_has_nothing_to_do_is_deaf() -> None:
    assert looks(Hearing(Broker(2)), LOOKS) == [False] * (LOOKS - 1) + [True]


@pytest.mark.parametrize(("messages", "idle"), [(2, False), (0, True), (None, True)], ids=["busy", "none", "away"])
def test_there_are_good_reasons_to_take_no_message(messages: int | None, idle: bool) -> None:
    assert not any(looks(Hearing(Broker(messages)), 3 * LOOKS, idle))


def test_each_good_reason_and_each_message_begins_the_count_anew() -> None:
    hearing = Hearing(Broker(2))
    assert not any(looks(hearing, LOOKS - 1) + looks(hearing, 1, idle=False) + looks(hearing, LOOKS - 1))
    hearing.heard()
    assert not any(looks(hearing, LOOKS - 1))


@pytest.mark.parametrize(
    ("url", "checked"),
    [
        ("redis://localhost:1/0", None),
        ("rediss://localhost:1/0", ssl.CERT_REQUIRED),
        ("rediss://localhost:1/0?ssl_cert_reqs=none", ssl.CERT_NONE),
    ],
)
def test_the_certificate_of_a_redis_by_tls_is_checked_unless_its_url_says_otherwise(
    url: str, checked: ssl.VerifyMode | None
) -> None:
    wanted = make_queue(read_settings(broker_url=url)).connection_for_write().ssl
    assert wanted["ssl_cert_reqs"] == checked if wanted else checked is None
