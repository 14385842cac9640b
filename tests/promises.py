"""What is promised in seconds: it is checked on a quiet machine (`make nightly`); nothing else depends on speed."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

checked = False
"""Set by the option ``--promises``."""


@contextmanager
def kept(seconds: float) -> Iterator[None]:
    """See that what happens meanwhile takes no longer than is promised."""
    began = time.monotonic()
    yield
    took = time.monotonic() - began
    assert took < seconds or not checked, f"{seconds:g} s are promised, it took {took:.2f} s"
