from pathlib import Path

from tests.chaos.__main__ import torment
from tests.chaos.stack import running_stack


def test_nothing_is_lost_made_twice_or_left_over_while_everything_breaks(tmp_path: Path) -> None:
    """A short form of `make chaos`, without a full disk."""
    with running_stack(tmp_path, webs=2, workers=2) as stack:
        outcome = torment(stack, jobs=9, seconds=15, seed=4)
    assert {name: found for name, found in outcome.found.items() if found} == {}
    assert outcome.blows
