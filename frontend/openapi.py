"""Print the API's document as the page's types need it: without examples, which say nothing of types."""

import json
from typing import Any

from treestroke.api.app import make_app
from treestroke.settings import Settings


def bare(part: Any) -> Any:
    """Leave out the examples of a part of the document, and of all parts in it."""
    if isinstance(part, dict):
        return {key: bare(value) for key, value in part.items() if key not in ("example", "examples")}
    return [bare(one) for one in part] if isinstance(part, list) else part


if __name__ == "__main__":
    print(json.dumps(bare(make_app(Settings()).openapi())))
