"""`treestroke serve` with a worker that knows poisoned jobs; it takes the same arguments."""

import sys

from treestroke import cli, serve


class Child(serve.Child):
    """Runs the poisoned worker in the place of the product's."""

    def __init__(self, module: str, *others: object) -> None:
        super().__init__({"treestroke.worker": "tests.faults.poisoned_worker"}.get(module, module), *others)  # type: ignore[arg-type]


if __name__ == "__main__":
    serve.Child = Child  # type: ignore[misc]
    sys.exit(cli.main())
