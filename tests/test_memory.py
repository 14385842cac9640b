import platform
import subprocess
import sys

import pytest

FAULTS = """
import resource, sys
import numpy as np
from treestroke.memory import keep_freed_memory
if sys.argv[1] == "kept":
    keep_freed_memory()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(20):
    pictures = [np.ones(2**20) for _ in range(8)]
    del pictures
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def faults(kept: str) -> int:
    """Page faults of a process that makes eight pictures of 8 MiB again and again."""
    return int(subprocess.run([sys.executable, "-c", FAULTS, kept], capture_output=True, text=True, check=True).stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other C libraries keep memory by rules of their own")
def test_freed_memory_is_used_again_without_page_faults() -> None:
    assert faults("kept") < faults("as usual") / 4


CYCLES = """
import gc, sys, weakref
from treestroke.memory import keep_freed_memory, search_for_garbage_often

class Held: pass

keep_freed_memory()
if sys.argv[1] == "often":
    search_for_garbage_often()
held = Held()
held.itself, seen = held, weakref.ref(held)
del held
kept = [[] for _ in range(50_000)]
print(seen() is None)
"""


@pytest.mark.parametrize(("how", "freed"), [("often", "True"), ("seldom", "False")])
def test_a_process_that_goes_on_frees_what_cycles_hold(how: str, freed: str) -> None:
    found = subprocess.run([sys.executable, "-c", CYCLES, how], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == freed
