"""A leaf's picture, drawn here."""

import cv2
import numpy as np

PURPLE = (130, 60, 140)


def leaf_picture(side: int = 300) -> np.ndarray:
    """A purple oval on a stalk that ends below, with transparent pixels around it."""
    picture = np.zeros((side, side, 4), np.uint8)
    picture[..., 1] = 255
    cv2.ellipse(picture, (side // 2, side * 2 // 5), (side // 5, side // 3), 0, 0, 360, (*PURPLE, 255), -1)
    cv2.line(picture, (side // 2, side // 2), (side // 2, side * 9 // 10), (*PURPLE, 255), max(2, side // 50))
    return picture
