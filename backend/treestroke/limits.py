"""How much the library and the service accept: plain numbers that every layer may import."""

MAX_STROKES = 200
"""Most strokes of a tree, the crown among them."""
MAX_POINTS = 10_000
"""Most points of one stroke."""
MIN_CANVAS, MAX_CANVAS = 16, 16_384
"""Least and greatest side of a sketch's canvas, px."""
MAX_PHOTO_BYTES = 25_000_000
"""Most bytes of an uploaded photo."""
MIN_PHOTOS, MAX_PHOTOS = 5, 60
"""Fewest photos whose cameras are looked for, and most photos of a capture."""
MAX_TEXT_BYTES = 64_000_000
"""Most bytes of JSON: more than the longest allowed strokes need."""
MAX_STRUCTURE_BYTES = 32_000_000
"""Most bytes of the file that holds a capture's cameras and points."""
MAX_SKETCH_BYTES = 25_000_000
"""Most bytes of a sketch's picture."""
MAX_LEAF_BYTES = 4_000_000
"""Most bytes of the picture of a leaf or a fruit."""
MAX_CLIP_BYTES = 300_000_000
"""Most bytes of a clip's file."""
MIN_CLIP_FRAMES, MIN_CLIP_SECONDS, MAX_CLIP_SECONDS = 24, 1.0, 60.0
"""Fewest frames and least seconds of a clip; what is longer is cut there."""
MAX_CLIP_RATE = 30.0
"""Most frames a second that are taken of a clip."""
MAX_FRAME = 9999
"""Largest index of a frame that strokes may name."""
MAX_CLIP_SIDE, FRAME_SIDE = 4096, 640
"""Longest side, px, of a clip's picture that is drawn on, and of its grey frames."""
MAX_NAME = 200
"""Most characters of a model's name."""
MAX_TAGS, MAX_TAG = 20, 40
"""Most tags of a model, and characters of each."""
SHARE_DAYS, MAX_SHARE_DAYS = 30, 365
"""Days that a link to a model leads somewhere, where nothing else is asked for, and most of them."""
MAX_ID = 40
"""Most characters of the id of a photo or a capture in a request."""
MAX_REV = 2**53 - 1
"""Largest whole number that every JSON reader keeps exactly."""
MAX_CLOUD_POINTS = 5000
"""Most points of a capture's cloud that a response holds."""
MAX_EDITS = 500
"""Most edits of a capture's visible branches."""
MAX_EDIT_POINTS = 1000
"""Most points of a branch that an edit adds."""
MAX_COORDINATE = 1e9
"""Greatest coordinate of an edit, in the capture's frame."""
