"""Colours of one photo's foliage, as clusters of its pixels."""

from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.types import Floats, Indices, Mask, Picture

SAMPLES = 6000
"""Foliage pixels that are clustered; more of them change no cluster by more than the photo's noise."""
ROUNDS, RING_ROUNDS = 11, 10
"""Steps of k-means for the foliage and for the ring; centres move by under one Lab unit after eight (11 photos)."""
RING_WIDTH = 0.06
"""Width of the ring around the foliage that shows the background, as a share of the foliage's height."""
RING_CLUSTERS = 4
"""Colours that the background is reduced to."""
DISTINCT = 20.0
"""Least distance, CIE Lab, of a background colour from the foliage's median colour to be told apart from it."""
BLENDED = 0.3
"""Share of background in a pixel's colour, 0 to 1, above which the pixel is seen through."""
OFF_LINE = 18.0
"""Greatest distance, CIE Lab, of a blend of foliage and background from the line between their two colours."""
TINT_REMOVED = 0.6
"""Share of the background's hue that is removed from foliage that is tinted by it (blue sky on white petals)."""
BACKGROUND_SHARE = 0.3
"""Greatest share of the foliage's pixels that is dropped as background."""
SHADOWS_KEPT, LIGHTS_KEPT = 0.65, 0.95
"""Share of the contrast in lightness that is kept below and above the mean.

The viewer shades the crown again, so the shade that the photo already contains is reduced. Judged on renders of 5
photos.
"""
GAIN = 1.1
"""Factor on colours, for the same reason: a crown under sun and sky shows about 0.8 of its leaves' lightness."""
LIGHTEST = 94.0
"""Lightness, CIE Lab, up to which colours are brightened, so that white petals keep their contrast."""


@dataclass(frozen=True, eq=False)
class Palette:
    """Clusters of foliage colour, the most common first.

    Attributes
    ----------
    centres
        (k, 3) mean of each cluster, CIE Lab (L 0 to 100), as `flattened`.
    shares
        (k,) share of the foliage pixels in each cluster, summing to 1.
    members
        k arrays (m, 3) of the clusters' pixels, CIE Lab, as `flattened`.
    """

    centres: Floats
    shares: Floats
    members: tuple[Floats, ...]


def lab_from_rgb(rgb: Picture) -> Floats:
    """Convert sRGB (..., 3) uint8 to CIE Lab (..., 3), L 0 to 100.

    Source: CIE 1976 L*a*b* for the white D65, by OpenCV.
    """
    flat = np.ascontiguousarray(rgb.reshape(1, -1, 3), dtype=np.float32) / np.float32(255)
    return np.asarray(cv2.cvtColor(flat, cv2.COLOR_RGB2LAB), dtype=np.float64).reshape(rgb.shape)


def rgb_from_lab(lab: Floats) -> Picture:
    """Convert CIE Lab (..., 3) to sRGB (..., 3) uint8, clipped to the colours that sRGB holds.

    Source: CIE 1976 L*a*b* for the white D65, by OpenCV.
    """
    flat = np.ascontiguousarray(lab.reshape(1, -1, 3), dtype=np.float32)
    rgb = np.asarray(cv2.cvtColor(flat, cv2.COLOR_LAB2RGB)).reshape(lab.shape)
    return np.asarray(np.clip(np.rint(rgb * 255), 0, 255), dtype=np.uint8)


def nearest_colour(lab: Floats, centres: Floats) -> tuple[Indices, Floats]:
    """Return the index (n,) and squared distance (n,) of the nearest centre (k, 3) to each colour (n, 3), CIE Lab."""
    best = np.zeros(len(lab), dtype=np.int64)
    least = np.full(len(lab), np.inf)
    lightness, red, yellow = np.ascontiguousarray(lab.T)
    for index, centre in enumerate(centres.tolist()):
        square = (lightness - centre[0]) ** 2 + (red - centre[1]) ** 2 + (yellow - centre[2]) ** 2
        closer = square < least
        np.copyto(best, index, where=closer)
        np.copyto(least, square, where=closer)
    return best, least


def flattened(lab: Floats) -> Floats:
    """Reduce the contrast in lightness of colours (n, 3), CIE Lab, shadows more than lights, then brighten all."""
    mean = lab[:, 0].mean()
    kept = np.where(lab[:, 0] < mean, SHADOWS_KEPT, LIGHTS_KEPT)
    lightness = np.minimum(GAIN * (mean + kept * (lab[:, 0] - mean)), np.maximum(lab[:, 0], LIGHTEST))
    return np.stack([lightness, GAIN * lab[:, 1], GAIN * lab[:, 2]], axis=1)


def foliage_palette(photo: Picture, mask: Mask, clusters: int, rng: np.random.Generator) -> Palette:
    """Cluster the pixels of a mask (h, w) on a photo (h, w, 3), sRGB, by k-means in CIE Lab.

    Pixels at the mask's border are left out, since sky shines into them, and so are pixels that blend the foliage's
    colour with one seen around the crown's upper half. The photo's light is reduced (`flattened`).

    Source: k-means, Lloyd 1982. Removing background and light is ours.

    Raises
    ------
    ValueError
        The mask is empty or not of the photo's size.
    """
    if mask.shape != photo.shape[:2] or not mask.any():
        raise ValueError(f"a palette needs a mask with foliage of the photo's size, got {mask.shape}")
    inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    samples = _sample(photo, inner if inner.sum() > mask.sum() // 10 else mask, rng)
    samples = _without_background(samples, _sample(photo, _background_ring(mask), rng), rng)
    samples = flattened(samples)
    labels = _k_means(samples, clusters, ROUNDS, rng)
    counts = np.bincount(labels)
    order = [int(k) for k in np.argsort(-counts, kind="stable") if counts[k] > 0]
    members = tuple(samples[labels == k] for k in order)
    return Palette(np.stack([m.mean(axis=0) for m in members]), counts[order] / counts.sum(), members)


def _sample(photo: Picture, mask: Mask, rng: np.random.Generator) -> Floats:
    """Draw the colours (n, 3), CIE Lab, of up to SAMPLES pixels of a mask (h, w)."""
    index = np.flatnonzero(mask)
    if len(index) > SAMPLES:
        index = index[np.sort(rng.choice(len(index), SAMPLES, replace=False))]
    return lab_from_rgb(photo.reshape(-1, 3)[index])


def _background_ring(mask: Mask) -> Mask:
    """Mark the pixels (h, w) around the foliage's upper half, beyond its blurred border."""
    rows = np.flatnonzero(mask.any(axis=1))
    far = max(4, round(RING_WIDTH * (rows[-1] - rows[0] + 1)))
    outside = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 3)
    outside[(rows[0] + rows[-1]) // 2 :] = 0
    return np.asarray((outside > 2.5) & (outside <= far), dtype=np.bool_)


def _k_means(samples: Floats, clusters: int, steps: int, rng: np.random.Generator) -> Indices:
    """Label samples (n, 3) with up to ``clusters`` clusters (n,), by this many steps of Lloyd's algorithm.

    OpenCV runs the steps: it is imported anyway, while importing scikit-learn takes longer than painting all leaves.
    Samples are centred, so that its 32-bit floats round their distances less.
    """
    first = nearest_colour(samples, _seed_colours(samples, clusters, rng))[0]
    labels = first.astype(np.int32)[:, None]
    centred = (samples - samples.mean(axis=0)).astype(np.float32)
    criteria = (cv2.TERM_CRITERIA_MAX_ITER, steps, 0.0)
    cv2.kmeans(centred, int(first.max()) + 1, labels, criteria, 1, cv2.KMEANS_USE_INITIAL_LABELS)
    return np.asarray(labels[:, 0], dtype=np.int64)


def _seed_colours(samples: Floats, clusters: int, rng: np.random.Generator) -> Floats:
    """Draw up to ``clusters`` of the samples (n, 3) far from each other (k, 3), fewer if there are fewer colours.

    Source: k-means++, Arthur and Vassilvitskii 2007. OpenCV's own start draws from a generator that the process shares.
    """
    centres = samples[rng.integers(len(samples))][None]
    least = nearest_colour(samples, centres)[1]
    while len(centres) < clusters and least.max() > 0:
        chosen = np.searchsorted(np.cumsum(least), rng.random() * least.sum())
        centres = np.vstack([centres, samples[min(int(chosen), len(samples) - 1)]])
        least = np.minimum(least, nearest_colour(samples, centres[-1:])[1])
    return np.asarray(centres)


def _cluster_means(samples: Floats, labels: Indices) -> Floats:
    """Mean colours (k, 3) of the samples (n, 3) with each label (n,)."""
    return np.asarray([samples[labels == label].mean(axis=0) for label in range(int(labels.max()) + 1)])


def _without_background(samples: Floats, ring: Floats, rng: np.random.Generator) -> Floats:
    """Drop the samples (n, 3) that are background seen between leaves, and reduce its tint in the others.

    ``ring`` (m, 3) samples the background; all colours are CIE Lab. Samples with the largest share of background are
    dropped first, at most BACKGROUND_SHARE of all.
    """
    if len(ring) == 0:
        return samples
    foliage, share = np.median(samples, axis=0), np.zeros(len(samples))
    backgrounds = _cluster_means(ring, _k_means(ring, RING_CLUSTERS, RING_ROUNDS, rng))
    for background in backgrounds:
        share = np.maximum(share, _background_share(samples, foliage, background))
    limit = np.sort(share)[-1 - int(BACKGROUND_SHARE * len(share))]
    samples = samples[(share <= BLENDED) | (share <= limit)]
    for background in backgrounds:
        samples = _without_tint(samples, foliage, background)
    return samples


def _without_tint(samples: Floats, foliage: Floats, background: Floats) -> Floats:
    """Remove most of a background's hue (3,) from samples (n, 3) that deviate toward it from the foliage's median."""
    offset = background - foliage
    offset[0] = 0.0
    length = float(np.hypot(offset[1], offset[2]))
    if length < DISTINCT:
        return samples
    share = ((samples - foliage) * offset).sum(axis=1) / length**2
    return np.asarray(samples - TINT_REMOVED * np.maximum(share, 0.0)[:, None] * offset)


def _background_share(samples: Floats, foliage: Floats, background: Floats) -> Floats:
    """Share (n,) of the background's colour in each sample (n, 3); 0 where it is not a blend of the two colours."""
    offset = background - foliage
    length = float(np.sqrt((offset**2).sum()))
    if length < DISTINCT:
        return np.zeros(len(samples))
    share = ((samples - foliage) * offset).sum(axis=1) / length**2
    off_line = np.sqrt((((samples - foliage) - share[:, None] * offset) ** 2).sum(axis=1))
    return np.where(off_line < OFF_LINE, share, 0.0)
