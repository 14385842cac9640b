"""What schemathesis cannot make up: bytes of a photo, a photo that is stored, strokes that describe its tree."""

import os
from itertools import count
from typing import Any

import schemathesis
from hypothesis import strategies
from schemathesis.transport.serialization import Binary
from tests.api import drawn
from tests.api.corpora import saved

from treestroke.codec.video_kinds import VIDEO_KINDS
from treestroke.wire_requests import SKETCHES_EXAMPLE
from treestroke.wire_strokes import STROKES_EXAMPLE

PICTURE = drawn.picture_of_the_example()
PHOTO = saved(PICTURE, "JPEG")
_numbers = count()
STORED = os.environ.get("STORED_PHOTO", "")
LEFT_OUT = object()
_EVIDENCE = (
    {"photo": STORED},
    {"photo": STORED, "strokes": STROKES_EXAMPLE, "sketches": LEFT_OUT},
    {"photo": LEFT_OUT, "strokes": LEFT_OUT, "sketches": SKETCHES_EXAMPLE},
    {"photo": STORED, "strokes": STROKES_EXAMPLE, "sketches": {"side": SKETCHES_EXAMPLE["side"]}},
)
for kind, content in (
    ("image/jpeg", PHOTO),
    ("image/png", saved(PICTURE, "PNG")),
    ("image/webp", saved(PICTURE, "WEBP")),
    ("image/heic", saved(PICTURE, "HEIF")),
    ("image/heif", saved(PICTURE, "HEIF")),
    ("image/avif", saved(PICTURE, "AVIF")),
    ("image/tiff", saved(PICTURE, "TIFF")),
    ("image/*", PHOTO),
    ("application/octet-stream", PHOTO),
    *((kind.media_type, b"") for kind in VIDEO_KINDS),
    ("video/*", b""),
    ("application/partial-upload", b""),
):
    schemathesis.openapi.media_type(kind, strategies.just(content))


schemathesis.openapi.format("binary", strategies.just(Binary(PHOTO)))


@schemathesis.hook
def before_call(context: schemathesis.HookContext, case: schemathesis.Case, kwargs: dict[str, Any]) -> None:
    """Put these into JSON that is meant to be right, together as they make a tree.

    Each request has a key of its own: the same key gives the first one's model, which may have been deleted since.
    """
    generation = case.meta.generation if case.meta else None
    positive = generation is not None and generation.mode.is_positive
    for name in [name for name in case.headers or {} if positive and name.lower() == "idempotency-key"]:
        case.headers[name] = f"{case.headers[name]}{next(_numbers)}"[-255:]
    if positive and case.operation.label == "POST /v1/models" and case.media_type == "application/json":
        case.body = {**case.body, **_EVIDENCE[len(str(case.body)) % 4]}
        for name in ("photo", "strokes", "sketches"):
            if case.body.get(name) is LEFT_OUT:
                del case.body[name]
