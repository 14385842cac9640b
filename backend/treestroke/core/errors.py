"""Errors in what the user gave.

TreestrokeError              the input cannot be used; the message says what is wrong, where, how to mend it
├── PhotoError               the picture itself
├── LeafError                the picture of a leaf
├── FruitError               the picture of a fruit
├── EnvelopeError            the outline that a sibling is to fill
├── CaptureError             several photos that do not show one tree from different places
├── ClipError                a video that does not show one tree that moves
├── StrokesError             a stroke, a sketch, or their file
└── SettingsError            a setting's name or value

A programmer's mistake (wrong shape, broken invariant) is a ValueError instead.
"""

from typing import ClassVar, Self

LONGEST_SHOWN = 60
"""Most characters of a value that a message repeats."""
LONGEST_POINTED = 200
"""Most characters of a key that a pointer repeats."""


class TreestrokeError(Exception):
    """An input that cannot be used; the message is one line for the person who gave it.

    Attributes
    ----------
    code
        What is wrong, for programs: snake_case and stable.
    pointer
        JSON pointer (RFC 6901) to the faulty part of the input, such as ``/branches/0/points/3``; "" for the whole.
    """

    usual_code: ClassVar[str] = "bad_input"
    whole: ClassVar[str] = "input"
    """What a message calls the input as a whole."""

    def __init__(self, message: str, *, code: str = "", pointer: str = "") -> None:
        super().__init__(_printable(message))
        self.code = code or self.usual_code
        self.pointer = pointer

    @classmethod
    def at(cls, place: tuple[str | int, ...], what: str, code: str, *, key: str = "") -> Self:
        """Return the error that says ``what`` is wrong at a place, given by its keys from the outside in.

        The pointer leads on to ``key``, which the text names by itself.
        """
        keys = (*place, key) if key else place
        text = "/".join(map(str, place))[:LONGEST_SHOWN] or cls.whole
        return cls(f"{text}: {what}", code=code, pointer="".join(f"/{_escaped(str(one))}" for one in keys))

    def within(self, name: str) -> Self:
        """Return the same error with the name of the file before its message."""
        return type(self)(f"{name}: {self}", code=self.code, pointer=self.pointer)


class PhotoError(TreestrokeError):
    """The photo cannot be read, or is too small, too large or not one frame."""

    usual_code = "photo_unreadable"
    whole = "photo"


class LeafError(TreestrokeError):
    """The picture of a leaf cannot be read, or has no leaf cut out."""

    usual_code = "leaf_unreadable"
    whole = "leaf"


class FruitError(TreestrokeError):
    """The picture of a fruit cannot be read, or has no fruit cut out."""

    usual_code = "fruit_unreadable"
    whole = "fruit"


class EnvelopeError(TreestrokeError):
    """The outline that a sibling is to fill cannot be read, or encloses nothing."""

    usual_code = "envelope_unreadable"
    whole = "envelope"


class CaptureError(TreestrokeError):
    """Photos from which no cameras are found: too few, too little overlap, all from one place."""

    usual_code = "capture_unusable"
    whole = "photos"


class ClipError(TreestrokeError):
    """A video that cannot be read, is too short or too dark, or in which nothing moves."""

    usual_code = "clip_unreadable"
    whole = "clip"


class StrokesError(TreestrokeError):
    """A stroke is malformed, or the strokes together do not describe a tree."""

    usual_code = "strokes_invalid"
    whole = "strokes"


class SettingsError(TreestrokeError):
    """A setting is unknown or out of range."""

    usual_code = "setting_invalid"
    whole = "settings"


def shown(value: object) -> str:
    """Return a value as text for a message, cut short; never raises."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # thousands of digits; lists in lists in lists
        return f"{type(value).__name__} too long to show"
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 3]}..."


def _printable(message: str) -> str:
    """Escape what does not belong in a line of text: line ends, NUL, lone surrogates."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in message)


def _escaped(key: str) -> str:
    """Return a key as part of a JSON pointer (RFC 6901); of a very long one the beginning."""
    return _printable(key[:LONGEST_POINTED]).replace("~", "~0").replace("/", "~1")
