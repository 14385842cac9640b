"""How much the library and the service accept: plain numbers that every layer may import."""

MAX_STROKES = 200
"""The crown's stroke among them."""
MAX_POINTS = 10_000
"""Of one stroke."""
MIN_CANVAS, MAX_CANVAS = 16, 16_384
"""Px, of a sketch's side."""
MAX_PHOTO_BYTES = 25_000_000
"""Of an uploaded photo."""
MAX_TEXT_BYTES = 64_000_000
"""Of JSON: more than the longest strokes that are allowed ever need."""
MAX_SKETCH_BYTES = 25_000_000
"""Of a sketch's picture."""
MAX_LEAF_BYTES = 4_000_000
"""Of the picture of a leaf or a fruit."""
MAX_NAME = 200
"""Characters of a model's name."""
MAX_ID = 40
"""Characters that may be sent as a photo's id."""
MAX_REV = 2**53 - 1
"""Largest whole number that every JSON reader keeps exactly."""
