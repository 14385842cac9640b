"""How a process of ours uses memory: freed memory is kept for the next picture, and garbage seldom searched for."""

import ctypes
import gc

_SELDOM, _OFTEN = 300_000, 10_000
"""Objects made since the last search for garbage that start the next one, in a command and in a process that goes on: a
command with its imports makes 100,000."""
_LARGEST_KEPT, _MOST_KEPT = 32 * 2**20, 256 * 2**20
"""Bytes: the largest block of memory, and the most free memory, that the C library keeps; 32 MiB is its own limit."""
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
"""Names of glibc's ``mallopt`` (malloc.h)."""


def keep_freed_memory() -> None:
    """Save a command the time that numpy's and Python's usual memory costs a tree.

    glibc hands each large freed block back to the system, which clears it page by page for the next array: half of
    all page faults of a model. Elsewhere nothing changes. Modules stay until the end and a tree leaves hardly any
    cycles, so garbage is searched for far less often than usual.
    """
    gc.set_threshold(_SELDOM)
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _LARGEST_KEPT)
        mallopt(_TRIM_THRESHOLD, _MOST_KEPT)


def search_for_garbage_often() -> None:
    """Let a process that goes on for days free what cycles hold; what its imports made stays."""
    gc.freeze()
    gc.set_threshold(_OFTEN)
