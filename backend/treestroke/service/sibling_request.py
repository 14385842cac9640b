"""A request for siblings of a stored model, read and checked."""

from dataclasses import dataclass

from treestroke.codec.envelope import encode_envelope, envelope_from
from treestroke.codec.refusals import checked, inside
from treestroke.core.errors import EnvelopeError, TreestrokeError
from treestroke.service.model_request import read_body
from treestroke.wire_requests import SiblingsRequest


@dataclass(frozen=True)
class SiblingsAsked:
    """What siblings were asked for: how many, the file of their outline, a scene, a seed of their own, a name."""

    count: int
    envelope: bytes | None
    scene: bool
    seed: int | None
    name: str


def read_siblings(body: bytes) -> SiblingsAsked:
    """Return the request for siblings that JSON holds.

    Raises
    ------
    TreestrokeError
        It is not such a request, or something in it cannot be used; the pointer leads into the request.
    """
    request = checked(SiblingsRequest, read_body(body), TreestrokeError)
    given, outline = request.envelope, None
    if given is not None:
        try:
            outline = encode_envelope(envelope_from(given if isinstance(given, str) else {"points": given.points}))
        except EnvelopeError as error:
            raise inside(("envelope",), error) from error
    return SiblingsAsked(request.count, outline, request.scene, request.seed, request.name)
