"""What the service sends of links to models in its responses, for its documents and its clients."""

from typing import Literal

from pydantic import ConfigDict, Field

from treestroke.wire_strokes import Wire


class ShareInfo(Wire):
    """A link by which anybody sees a model."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "shr_4d5e6f708192a3b4c5d6e7f8",
                "url": "http://127.0.0.1:8000/s/mZ2m3Qw0sN1bX5yT7uV9aA",
                "created": "2026-05-04T09:33:00.000Z",
                "expires": "2026-06-03T09:33:00.000Z",
                "revoked": None,
                "photo": False,
                "download": True,
            }
        }
    )

    id: str
    url: str | None = Field(description="told once, when it is made")
    created: str
    expires: str
    revoked: str | None
    photo: bool = Field(description="whether the photo is shown, too")
    download: bool = Field(description="whether the tree is offered for download")


class ShareList(Wire):
    """The links to a model, newest first."""

    shares: list[ShareInfo]


class SharedModel(Wire):
    """What a link tells of a model: nothing of who made it."""

    name: str
    bytes: int = Field(description="of the tree's GLB")
    foliage: str | None = Field(description="what the twigs bear")
    form: str | None = Field(description="how the limbs grow")
    height: float | None = Field(description="metres")
    photo: bool
    download: bool
    expires: str


class OEmbed(Wire):
    """How a link is embedded in a page (oEmbed 1.0)."""

    version: Literal["1.0"] = "1.0"
    type: Literal["rich"] = "rich"
    title: str
    provider_name: str
    provider_url: str
    html: str
    width: int
    height: int
