"""Names of arrays and of values that several stages share."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
"""(h, w) where it belongs to a picture."""
Opacity = NDArray[np.float32]
"""(h, w) share of each pixel of a picture, 0 to 1, that something covers."""
Picture = NDArray[np.uint8]
"""(h, w, 3) sRGB, or (h, w, 4) with straight alpha."""
FoliageKind = Literal["leaves", "needles", "bare"]
"""What twigs bear."""
