"""Photos as they are uploaded: in a form, or as the whole body."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import FormData, UploadFile

from treestroke.api.deps import check_length, form_of, media_type
from treestroke.api.errors import Refusal
from treestroke.codec.photo_kinds import MEDIA_TYPES

_RAW = (*MEDIA_TYPES, "image/*", "application/octet-stream")


def upload_body(kinds: Sequence[str]) -> dict[str, Any]:
    """Return what the API's document says of a body that is an upload: a form, or a file of one of these kinds."""
    binary = {"type": "string", "format": "binary"}
    form = {"type": "object", "required": ["file"], "properties": {"file": binary}, "additionalProperties": False}
    content = {"multipart/form-data": {"schema": form}, **{kind: {"schema": binary} for kind in kinds}}
    return {"requestBody": {"required": True, "content": content}}


UPLOAD_BODY = upload_body(_RAW)


@dataclass(frozen=True)
class Upload:
    """The bytes of a photo, and the name of its file; "" where it came without."""

    content: bytes
    name: str


def file_in(form: FormData, what: str) -> UploadFile:
    """Return the file in the field ``file`` of a form; a message calls it by ``what`` it is.

    Raises
    ------
    Refusal
        There is none.
    """
    file = form.get("file")
    if not isinstance(file, UploadFile):
        raise Refusal("bad_request", f"the form has no file in the field file; send the {what} there")
    return file


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
            file = file_in(form, "photo")
            upload = Upload(await file.read(), file.filename or "")
    check_length(upload.content)
    return upload


UploadOf = Annotated[Upload, Depends(_upload)]
