"""``python -m treestroke``."""

from treestroke.cli import run

run()
