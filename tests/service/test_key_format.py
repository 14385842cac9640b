import re
from itertools import combinations

import pytest

from treestroke.service.key_format import beginning_of, digest_of, is_key, new_key


def test_a_new_key_is_a_key_and_no_other_one() -> None:
    keys = {new_key() for _ in range(100)}
    assert len(keys) == 100
    assert all(re.fullmatch(r"ts_[0-9A-Za-z]{43}", key) and is_key(key) for key in keys)


def test_a_key_with_a_wrong_character_or_two_in_the_wrong_order_is_none() -> None:
    key = new_key()
    for at in range(3, len(key)):
        assert not is_key(f"{key[:at]}{'b' if key[at] == 'a' else 'a'}{key[at + 1 :]}")
    for first, second in combinations(range(3, len(key)), 2):
        swapped = list(key)
        swapped[first], swapped[second] = key[second], key[first]
        assert not is_key("".join(swapped)) or key[first] == key[second]


@pytest.mark.parametrize("change", [str.upper, str.strip, lambda key: key[:-1], lambda key: f"{key}\n", lambda _: ""])
def test_what_is_not_written_as_a_key_is_none(change: object) -> None:
    key = f" {new_key()}"
    assert not is_key(key)
    changed = change(key[1:]) if change is not str.strip else f"{key[1:]} "  # type: ignore[operator]
    assert not is_key(changed)


def test_a_digest_needs_the_secret_and_tells_nothing_of_the_key() -> None:
    key = new_key()
    assert digest_of("a" * 32, key) == digest_of("a" * 32, key) != digest_of("b" * 32, key)
    assert len(digest_of("a" * 32, key)) == 64
    assert key.startswith(beginning_of(key))
    assert len(beginning_of(key)) == 7
