"""What can go wrong through no fault of the program.

TreestrokeError              the user's input cannot be used; the message says what, where, how to mend it
├── PhotoError               the picture itself
├── StrokesError             a stroke or the stroke file
└── SettingsError            a setting's name or value

A programmer's mistake (wrong shape, broken invariant) is a ValueError instead.
"""


class TreestrokeError(Exception):
    """An input that cannot be used; the message is one line for the person who gave it."""


class PhotoError(TreestrokeError):
    """The photo cannot be read, or is too small, too large or not one frame."""


class StrokesError(TreestrokeError):
    """A stroke is malformed, or the strokes together do not describe a tree."""


class SettingsError(TreestrokeError):
    """A setting is unknown or out of range."""
