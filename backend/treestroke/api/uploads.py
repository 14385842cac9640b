"""Photos as they are uploaded: in a form, or as the whole body."""

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from treestroke.api.deps import check_length, form_of, media_type
from treestroke.api.errors import Refusal
from treestroke.codec.photo_kinds import MEDIA_TYPES

_RAW = (*MEDIA_TYPES, "image/*", "application/octet-stream")
_BINARY = {"type": "string", "format": "binary"}
UPLOAD_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": _BINARY},
                    "additionalProperties": False,
                }
            },
            **{kind: {"schema": _BINARY} for kind in _RAW},
        },
    }
}
"""What the API's document says of a body that is an upload."""


@dataclass(frozen=True)
class Upload:
    """The bytes of a photo, and the name of its file; "" where it came without."""

    content: bytes
    name: str


async def _upload(request: Request) -> Upload:
    """Return an upload: the field ``file`` of a form, or the whole body."""
    kind = media_type(request)
    if kind != "multipart/form-data":
        # A picture is judged by its bytes, not by its media type.
        if not kind.startswith("image/") and kind not in (*_RAW, ""):
            raise Refusal(
                "unsupported_media_type", f"send a form with the field file, or the photo itself as {' or '.join(_RAW)}"
            )
        upload = Upload(await request.body(), "")
    else:
        async with form_of(request, max_files=1, max_fields=0) as form:
            file = form.get("file")
            if not isinstance(file, UploadFile):
                raise Refusal("bad_request", "the form has no file in the field file; send the photo there")
            upload = Upload(await file.read(), file.filename or "")
    check_length(upload.content)
    return upload


UploadOf = Annotated[Upload, Depends(_upload)]
