"""What a tree is made of: the description of all parts and sources, and `Inputs`, the value that holds them.

A new part (a file beside a photo or a sketch) is one more entry of `PARTS`, a new source one more of `SOURCES`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from treestroke.codec.photo_kinds import ACCEPTED_FORMATS, extension_of
from treestroke.codec.video_kinds import ACCEPTED_VIDEOS, MP4, VIDEO_KINDS, video_kind
from treestroke.core.errors import (
    CaptureError,
    ClipError,
    EnvelopeError,
    FruitError,
    LeafError,
    PhotoError,
    StrokesError,
    TreestrokeError,
)
from treestroke.limits import (
    MAX_CLIP_BYTES,
    MAX_LEAF_BYTES,
    MAX_PHOTO_BYTES,
    MAX_SKETCH_BYTES,
    MAX_STRUCTURE_BYTES,
    MAX_TEXT_BYTES,
)

Content = TypeVar("Content", covariant=True)
PartKind = Literal[
    "photo", "clip", "strokes", "frame_strokes", "views", "edits", "structure", "sketch", "cutout", "envelope"
]
SourceName = Literal["photo", "views", "clip", "sketches"]

BEGINNING = 128
"""Bytes of a file that are enough to tell its format."""
PNG_BEGINNING = b"\x89PNG"


@dataclass(frozen=True)
class Format:
    """A file format that a part may have."""

    ending: str
    media_type: str
    max_bytes: int


TEXT = Format("json", "application/json", MAX_TEXT_BYTES)
STRUCTURE = Format("json", "application/json", MAX_STRUCTURE_BYTES)
SKETCH_PNG = Format("png", "image/png", MAX_SKETCH_BYTES)
CUTOUT_PNG = Format("png", "image/png", MAX_LEAF_BYTES)
_PHOTOS = tuple(
    Format(ending, f"image/{subtype}", MAX_PHOTO_BYTES)
    for ending, subtype in (
        ("jpg", "jpeg"),
        ("png", "png"),
        ("webp", "webp"),
        ("heic", "heic"),
        ("avif", "avif"),
        ("tif", "tiff"),
    )
)
_VIDEOS = tuple(Format(kind.ending, kind.media_type, MAX_CLIP_BYTES) for kind in VIDEO_KINDS)


@dataclass(frozen=True)
class Part:
    """Description of one part of a tree's inputs.

    Attributes
    ----------
    name
        Its key in requests, in project files and in the table of parts.
    title
        Its name in messages.
    kind
        How it is decoded. Strokes, edits and sketches are what the person drew.
    formats
        Those its file may have.
    refusal
        The error that says it cannot be used.
    help
        One line for the command line.
    many
        Whether it is any number of files, each named ``name/which``.
    """

    name: str
    title: str
    kind: PartKind
    formats: tuple[Format, ...]
    refusal: type[TreestrokeError]
    help: str
    many: bool = False

    @property
    def max_bytes(self) -> int:
        """Most bytes that a file of any of the formats may have."""
        return max(file_format.max_bytes for file_format in self.formats)

    @property
    def drawn(self) -> bool:
        """Whether the person drew it."""
        return self.kind in ("strokes", "frame_strokes", "views", "edits", "sketch")

    def format_of(self, beginning: bytes) -> Format:
        """Return the format of a file by its first `BEGINNING` bytes."""
        if self.kind == "photo":
            ending = extension_of(beginning)
        elif self.kind == "clip":
            ending = (video_kind(beginning) or MP4).ending
        else:
            ending = "png" if beginning.startswith(PNG_BEGINNING) else "json"
        return next((file_format for file_format in self.formats if file_format.ending == ending), self.formats[0])


PARTS: Mapping[str, Part] = {
    part.name: part
    for part in (
        Part(
            "photo",
            "a photo",
            "photo",
            _PHOTOS,
            PhotoError,
            f"{ACCEPTED_FORMATS}; with a front sketch, what it was drawn over",
        ),
        Part("strokes", "strokes", "strokes", (TEXT,), StrokesError, "stroke JSON; needed with a photo"),
        Part("photos", "photos", "photo", _PHOTOS, PhotoError, f"two photos or more, {ACCEPTED_FORMATS}", many=True),
        Part("views", "strokes over photos", "views", (TEXT,), StrokesError, "stroke JSON for some of the photos"),
        Part("edits", "edits of branches", "edits", (TEXT,), StrokesError, "edits of the branches that photos show"),
        Part(
            "structure",
            "the photos' cameras",
            "structure",
            (STRUCTURE,),
            CaptureError,
            "the photos' cameras, as they were found before",
        ),
        Part("clip", "a clip", "clip", _VIDEOS, ClipError, f"a video of the tree in the wind, {ACCEPTED_VIDEOS}"),
        Part(
            "frame_strokes",
            "strokes over a frame",
            "frame_strokes",
            (TEXT,),
            StrokesError,
            "stroke JSON for one frame of the clip",
        ),
        Part(
            "front",
            "a front sketch",
            "sketch",
            (TEXT, SKETCH_PNG),
            StrokesError,
            "sketch of the tree's front: stroke JSON or PNG",
        ),
        Part(
            "side",
            "a side sketch",
            "sketch",
            (TEXT, SKETCH_PNG),
            StrokesError,
            "sketch of the tree's left side: stroke JSON or PNG",
        ),
        Part(
            "leaf",
            "the picture of a leaf",
            "cutout",
            (CUTOUT_PNG,),
            LeafError,
            "a leaf cut out, stalk down, that the tree is to bear",
        ),
        Part(
            "fruit",
            "the picture of a fruit",
            "cutout",
            (CUTOUT_PNG,),
            FruitError,
            "a fruit cut out, stalk up, that the tree is to bear",
        ),
        Part(
            "envelope",
            "an outline of the siblings",
            "envelope",
            (TEXT, CUTOUT_PNG),
            EnvelopeError,
            "outline that siblings fill: heart, triangle, circle, pentagon, stroke JSON, or PNG of a shape",
        ),
    )
}
"""All parts, in the order in which they are stored and read."""
SIDES = tuple(name for name, part in PARTS.items() if part.kind == "sketch")
CUTOUTS = tuple(name for name, part in PARTS.items() if part.kind == "cutout")
BESIDE = (*CUTOUTS, "envelope")
"""Parts that may stand beside those of any source."""


@dataclass(frozen=True)
class Source:
    """Description of what a tree can be made of.

    Attributes
    ----------
    title
        Its needed parts in words.
    decided_by
        The part that makes inputs this source; each source has one of its own.
    needs
        Parts that must be there.
    options
        Parts that may be there.
    suggested_by
        The part that, where no source is decided, tells which one was probably meant.
    """

    name: SourceName
    title: str
    decided_by: str
    needs: tuple[str, ...]
    options: tuple[str, ...]
    suggested_by: str


SOURCES: Mapping[SourceName, Source] = {
    source.name: source
    for source in (
        Source("photo", "photo and strokes", "strokes", ("photo", "strokes"), ("side", *BESIDE), "photo"),
        Source(
            "views",
            "several photos and strokes over some of them",
            "views",
            ("photos", "views"),
            ("structure", "edits", *BESIDE),
            "photos",
        ),
        Source(
            "clip",
            "a clip and strokes over one of its frames",
            "frame_strokes",
            ("clip", "frame_strokes"),
            BESIDE,
            "clip",
        ),
        Source("sketches", "a front sketch", "front", ("front",), ("side", "photo", *BESIDE), "side"),
    )
}
_SOURCE_NEEDED = f"a tree is made of {', or of '.join(source.title for source in SOURCES.values())}"


@dataclass(frozen=True)
class Inputs(Generic[Content]):
    """What one tree is made of: its source, and its parts by name.

    ``Content`` is what stands for each part: its bytes, its stored file, or whatever the library takes (a path, pixels,
    plain values).
    """

    source: SourceName
    parts: Mapping[str, Content]

    @classmethod
    def of(cls, parts: Mapping[str, Content | None]) -> "Inputs[Content]":
        """Return the inputs that these parts make, in the order of `PARTS`; those that are None are absent.

        Raises
        ------
        TreestrokeError
            As `check_parts`.
        ValueError
            There is no part of such a name.
        """
        present = {name: content for name, content in parts.items() if content is not None}
        order = list(PARTS)
        names = sorted(present, key=lambda name: order.index(part_of(name).name))
        return cls(check_parts(present), {name: present[name] for name in names})


def part_of(name: str) -> Part:
    """Return the description of the part with this name, or of the many files that this one is among.

    Raises
    ------
    ValueError
        There is no such part.
    """
    described, slash, _ = name.partition("/")
    part = PARTS.get(described)
    if part is None or part.many != bool(slash):
        raise ValueError(f"{name!r} is not a part of a tree's inputs")
    return part


def check_parts(names: Iterable[str], within: tuple[str | int, ...] = ()) -> SourceName:
    """Return the source that parts of these names make; names that are not parts are ignored.

    ``within`` are the keys that lead to the sketches in a request.

    Raises
    ------
    TreestrokeError
        They make no source, or two.
    """
    present = {name.partition("/")[0] for name in names}
    decided = [source for source in SOURCES.values() if source.decided_by in present]
    if len(decided) > 1:
        first, second = decided[:2]
        message = f"there is {PARTS[second.decided_by].title} too, and {_SOURCE_NEEDED}; leave one of them out"
        raise TreestrokeError.at(_place(first.decided_by, within), message, "strokes_and_sketch")
    meant = (
        decided or [source for source in SOURCES.values() if source.suggested_by in present] or list(SOURCES.values())
    )
    source = meant[0]
    missing = next((name for name in source.needs if name not in present), None)
    if missing is not None:
        why = (
            f"{source.decided_by} need a {missing}; send it too" if decided else f"{_SOURCE_NEEDED}; send one of these"
        )
        raise TreestrokeError.at(_place(missing, within), f"missing: {why}", "missing_key")
    return source.name


def file_name(name: str, media_type: str) -> str:
    """Return the name of a part's file of this media type, such as ``side.png``."""
    return f"{name}.{next(form.ending for form in part_of(name).formats if form.media_type == media_type)}"


def _place(name: str, within: tuple[str | int, ...]) -> tuple[str | int, ...]:
    return (*within, name) if name in SIDES else (name,)
