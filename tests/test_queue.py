import pytest
from kombu.exceptions import OperationalError

from treestroke import queue
from treestroke.queue import Hearing, Hints

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
    return [hearing.is_lost(lambda: idle) for _ in range(number)]


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
