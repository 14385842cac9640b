"""Tracks: points of a tree that are followed through the frames of a video.

Source: Li et al. 2011, appendix A; Lucas and Kanade 1981 in pyramids (Bouguet 2000), checked forward and backward
(Kalal et al. 2010).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from treestroke.core.progress import Report, silent
from treestroke.core.types import Floats, Mask

MOST = 1500
"""Greatest number of points that begin in one frame."""
WINDOW = 21
"""Side of the window that is found again in the next frame, px."""
APART = 3.0
"""Least distance of points that begin, px."""
RETURNS = 1.0
"""How far from its start a point may end that is followed one frame and back, px."""
_QUALITY = 0.002  # of the best corner's smaller eigenvalue, below which a point is no corner
_ANEW = 10  # frames after which points begin where others were lost
_NEIGHBOURS = 8  # tracks from which it is known where a point that begins later was in the chosen frame
_FULL = 0.7  # of the first points: as long as so many are followed, none begin
_LOOK: dict[str, Any] = {
    "winSize": (WINDOW, WINDOW),
    "maxLevel": 3,
    "criteria": (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 0.01),
}


@dataclass(frozen=True, eq=False)
class Tracks:
    """Points that are followed, in px of the frames; f frames, k points.

    Attributes
    ----------
    points
        (f, k, 2) where each is; where it is not seen, where it was last or is first.
    seen
        (f, k) whether it is followed there.
    rest
        (k, 2) where it is in the chosen frame, or would be.
    """

    points: Floats
    seen: Mask
    rest: Floats

    def __len__(self) -> int:
        return len(self.rest)

    @property
    def moved(self) -> Floats:
        """(f, k, 2) how far each is from where it is in the chosen frame, px."""
        return self.points - self.rest

    def enlarged(self, factor: float) -> "Tracks":
        """Return the tracks in px of pictures that are larger by a factor."""
        return replace(self, points=self.points * factor, rest=self.rest * factor)


def follow(frames: NDArray[np.uint8], chosen: int, region: Mask, report: Report = silent, most: int = MOST) -> Tracks:
    """Follow the corners in a region (h, w) of the chosen frame through all frames (f, h, w), forward and backward.

    At most ``most`` begin in one frame. A point is lost where it leaves the picture, or does not come back to where it
    was from the next frame. Where many are lost, others begin.
    """
    count = len(frames)
    follower = _Follower(region, most)
    forward = follower.run(frames[chosen:], lambda part: report("follow", part * (count - chosen) / count))
    if chosen == 0:
        return forward
    done = (count - chosen) / count
    follower = _Follower(region, most)
    backward = follower.run(frames[chosen::-1], lambda part: report("follow", done + part * chosen / count))
    return _joined(backward, forward)


class _Follower:
    """Follows points frame by frame."""

    def __init__(self, region: Mask, most: int) -> None:
        self._most = most
        self._region = region.astype(np.uint8) * 255
        self.rest = np.empty((0, 2))
        self.points = np.empty((0, 2), dtype=np.float32)
        self.live = np.empty(0, dtype=bool)

    def run(self, frames: NDArray[np.uint8], progress: Callable[[float], None]) -> Tracks:
        """Follow the corners of the first frame's region through the frames in their order."""
        self._begin(frames[0])
        first = len(self.live)
        places, seen = [self.points.copy()], [self.live.copy()]
        for index in range(1, len(frames)):
            self._step(frames[index - 1], frames[index])
            if index % _ANEW == 0 and self.live.sum() < _FULL * first:
                self._begin(frames[index])
            places.append(self.points.copy())
            seen.append(self.live.copy())
            progress(index / len(frames))
        return _table(places, seen, self.rest)

    def _begin(self, frame: NDArray[np.uint8]) -> None:
        """Begin points at the region's corners where there are none."""
        moved = self.points[self.live] - self.rest[self.live]
        shift = np.median(moved, axis=0) if len(moved) else np.zeros(2)
        free = cv2.warpAffine(self._region, np.array([[1, 0, shift[0]], [0, 1, shift[1]]]), frame.shape[::-1])
        for x, y in np.rint(self.points[self.live]).astype(int).tolist():
            cv2.circle(free, (x, y), int(APART), 0, -1)
        found: Any = cv2.goodFeaturesToTrack(frame, self._most, _QUALITY, APART, mask=free)  # None without corners
        if found is None:
            return
        new = found[:, 0]
        self.rest = np.concatenate([self.rest, new - self._moved_near(new)])
        self.points = np.concatenate([self.points, new])
        self.live = np.append(self.live, np.ones(len(new), dtype=bool))

    def _step(self, before: NDArray[np.uint8], frame: NDArray[np.uint8]) -> None:
        """Follow the live points into the next frame."""
        index = np.flatnonzero(self.live)
        if not len(index):
            return
        start: Any = self.points[index]
        nowhere: Any = None  # the types of OpenCV do not know that it may be absent
        end, found, _ = cv2.calcOpticalFlowPyrLK(before, frame, start, nowhere, **_LOOK)
        back, _, _ = cv2.calcOpticalFlowPyrLK(frame, before, end, nowhere, **_LOOK)
        size = np.array(frame.shape[::-1])
        within = ((end >= 0) & (end < size)).all(axis=1)
        kept = (found[:, 0] > 0) & (np.linalg.norm(back - start, axis=1) < RETURNS) & within
        self.points[index[kept]] = end[kept]
        self.live[index[~kept]] = False

    def _moved_near(self, points: Floats) -> Floats:
        """Return how far live points near points (n, 2) are from their rest, px: the median of each coordinate."""
        live = np.flatnonzero(self.live)
        if len(live) < _NEIGHBOURS:
            return np.zeros((len(points), 2))
        _, near = cKDTree(self.points[live]).query(points, _NEIGHBOURS)
        return np.asarray(np.median((self.points[live] - self.rest[live])[near], axis=1))


def _table(places: list[NDArray[np.float32]], seen: list[NDArray[np.bool_]], rest: Floats) -> Tracks:
    """Make one table of what was known of each frame, whose later points are not in earlier frames."""
    count = len(rest)
    points, known = np.tile(rest, (len(places), 1, 1)), np.zeros((len(places), count), dtype=bool)
    for index, (place, live) in enumerate(zip(places, seen, strict=True)):
        points[index, : len(place)], known[index, : len(live)] = place, live
    return Tracks(points, known, rest)


def _joined(backward: Tracks, forward: Tracks) -> Tracks:
    """Join tracks from the chosen frame back to the first with those forward to the last.

    Both begin with the same points, which become one track each.
    """
    same = int(min((backward.seen[0]).sum(), (forward.seen[0]).sum()))
    before, after = len(backward.points) - 1, len(forward.points)
    rest = np.concatenate([forward.rest, backward.rest[same:]])
    points = np.tile(rest, (before + after, 1, 1))
    seen = np.zeros(points.shape[:2], dtype=bool)
    points[before:, : len(forward)], seen[before:, : len(forward)] = forward.points, forward.seen
    for first, last, part in ((0, same, slice(0, same)), (len(forward), len(rest), slice(same, None))):
        points[:before, first:last] = backward.points[:0:-1, part]
        seen[:before, first:last] = backward.seen[:0:-1, part]
    return Tracks(points, seen, rest)
