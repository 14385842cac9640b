"""``python -m treestroke``, and the command ``treestroke``."""

from typing import NoReturn

from treestroke.memory import keep_freed_memory


def run() -> NoReturn:
    """Run the command line; its imports make more objects than a tree does, so memory is kept from here on."""
    keep_freed_memory()
    from treestroke import cli

    cli.run()


if __name__ == "__main__":
    run()
