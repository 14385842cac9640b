"""Print what the page takes from the API's document: the types' source, or (by `defaults`) the default settings.

Examples are left out of the types' source, since they say nothing of types.
"""

import json
import sys
from typing import Any

from treestroke.api.app import make_app
from treestroke.settings import Settings


def bare(part: Any) -> Any:
    """Return a part of the document without its examples and those of all parts in it."""
    if isinstance(part, dict):
        return {key: bare(value) for key, value in part.items() if key not in ("example", "examples")}
    return [bare(one) for one in part] if isinstance(part, list) else part


def defaults(document: dict[str, Any]) -> str:
    """Return the default settings of the document as TypeScript."""
    settings = document["components"]["schemas"]["ModelSettings"]["properties"]
    lines = [f"  {name}: {_written(setting['default'])},\n" for name, setting in settings.items()]
    return (
        "import type { components } from './schema'\n\n"
        "/** Written by `make types` from the API's document. */\n"
        f"export const DEFAULT_SETTINGS: Required<components['schemas']['ModelSettings']> = {{\n{''.join(lines)}}}\n"
    )


def _written(value: Any) -> str:
    """Return a value as the page's formatter writes it."""
    if isinstance(value, str):
        return f"'{value}'"
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)


if __name__ == "__main__":
    document = make_app(Settings()).openapi()
    sys.stdout.write(defaults(document) if "defaults" in sys.argv else json.dumps(bare(document)))
