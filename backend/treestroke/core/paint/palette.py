"""Colours of one photo's foliage, as clusters of its pixels."""

from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.imaging.light import luminance_of_lightness
from treestroke.core.types import Floats, Indices, Mask, Opacity, Picture

SAMPLES = 6000
"""Foliage pixels that are clustered; more of them change no cluster by more than the photo's noise."""
ROUNDS = 11
"""Steps of k-means; centres move by under one Lab unit after eight (11 photos)."""
INNER_SHARE = 0.1
"""Share of the foliage that must remain when pixels count by their neighbours; in thinner foliage they count alone."""
SPRAY = 0.014
"""Side of the window over which a spray's colour is averaged, as a share of the foliage's width."""
UNSHADED = 2.2
"""Gain in linear light from leaves in a photo, which shade each other, to leaves alone: a viewer shades them again (at
2.0 crowns came out 4 darker, CIE Lab, in the median of 17 photos, and their colours as much paler)."""
CONTRAST = 1.5
"""Factor on small differences of lightness, part of which overlapping cards and their soft shading blur away; black and
white stay. Higher ones make clumps of light and dark truer, but stronger than leaves, and shade turns black (4 photos:
at 1.4 details of 0.35 to 5.6 % of a tree's height were off by 5 to 11 %, at 1.7 by 4 to 16 %)."""
OF_LIGHTNESS = 0.4
"""Weight of lightness in clusters, against that of hue: cards are dimmed as they need it, while a hue needs a tile of
its own (at 1.0 a maple of yellow and red leaves came out orange with other random numbers)."""
DETAIL = 1.5
"""Factor on how much lighter or darker leaves are than their spray, up to the lightest and darkest: cards blur them. At
1.0 details of a leaf's size were a fifth weaker than in 4 photos, at 2.0 some were stronger."""


@dataclass(frozen=True, eq=False)
class Palette:
    """Clusters of sprays by their colour, the most common first; the leaves of a spray differ.

    Attributes
    ----------
    centres
        (k, 3) mean of each cluster, CIE Lab (L 0 to 100), as `unshaded`.
    shares
        (k,) share of the foliage pixels in each cluster, summing to 1.
    members
        k arrays (m, 3) of the clusters' pixels, CIE Lab, as `unshaded`.
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


def unshaded(lab: Floats) -> Floats:
    """Turn colours of a crown (n, 3), CIE Lab, into those of leaves alone, which cards show.

    They are brighter, as if leaves did not shade each other, and differ more in lightness, since cards blur it. Hues
    stay, and white stays white.
    """
    mean = lab[:, :1].mean()
    way = np.maximum(np.where(lab[:, :1] < mean, mean, 100.0 - mean), 1.0)
    away = (lab[:, :1] - mean) / way
    lightness = mean + way * CONTRAST * away / np.sqrt(1 + (CONTRAST**2 - 1) * away**2)
    luminance = luminance_of_lightness(lightness)
    lightness = np.cbrt(UNSHADED / (1 + (UNSHADED - 1) * luminance)) * (lightness + 16) - 16
    return np.concatenate([lightness, lab[:, 1:] * (lightness + 16) / (lab[:, :1] + 16)], axis=1)


def foliage_palette(
    photo: Picture, cover: Opacity | Mask, clusters: int, rng: np.random.Generator, across_px: float | None = None
) -> Palette:
    """Cluster the sprays of a foliage on a photo (h, w, 3), sRGB, by k-means of their colours, hue before lightness.

    ``cover`` (h, w) is the share of each pixel that shows a leaf in its own colour. A cluster's members are single
    pixels: leaves lie beside lighter and darker ones, as in the photo, though differing more by `DETAIL`. Pixels count
    by the least cover of their neighbours, since sky shines into a leaf's border. The foliage is ``across_px`` wide, as
    wide as the cover where that is None.

    Source: k-means, Lloyd 1982; clustering by what surrounds a pixel is ours.

    Raises
    ------
    ValueError
        Nothing is covered, or the cover is not of the photo's size.
    """
    if cover.shape != photo.shape[:2] or not cover.any():
        raise ValueError(f"a palette needs a cover with foliage of the photo's size, got {cover.shape}")
    share = np.asarray(cover, dtype=np.float32)
    inner = cv2.erode(share, np.ones((3, 3), np.uint8))
    index = _drawn(np.asarray(inner if inner.sum() > INNER_SHARE * share.sum() else share, dtype=np.float32), rng)
    across = float(np.count_nonzero(share.any(axis=0))) if across_px is None else across_px
    pixels = photo.reshape(-1, 3)[index], _spray_colours(photo, share, index, across)
    samples, sprays = (unshaded(lab_from_rgb(colours)) for colours in pixels)
    labels = _k_means(sprays * (OF_LIGHTNESS, 1.0, 1.0), clusters, ROUNDS, rng)
    counts = np.bincount(labels)
    order = [int(k) for k in np.argsort(-counts, kind="stable") if counts[k] > 0]
    leaves = _differing_more(samples, sprays)
    members = tuple(leaves[labels == k] for k in order)
    return Palette(np.stack([m.mean(axis=0) for m in members]), counts[order] / counts.sum(), members)


def _differing_more(leaves: Floats, sprays: Floats) -> Floats:
    """Make leaves (n, 3) differ by `DETAIL` from their sprays (n, 3), CIE Lab, in lightness, at the same saturation."""
    lightness, of_spray = leaves[:, 0], sprays[:, 0]
    wanted = np.clip(of_spray + DETAIL * (lightness - of_spray), lightness.min(), lightness.max())
    return leaves * (wanted / np.maximum(lightness, 1.0))[:, None]


def _drawn(weight: Opacity, rng: np.random.Generator) -> Indices:
    """Draw up to SAMPLES different pixels by their weight (h, w), as flat indices in rising order."""
    index = np.flatnonzero(weight)
    if len(index) <= SAMPLES:
        return index
    # the largest of random keys u^(1/w) are a weighted draw (Efraimidis and Spirakis 2006)
    keys = np.log(rng.random(len(index))) / weight.ravel()[index]
    return np.sort(index[np.argpartition(keys, -SAMPLES)[-SAMPLES:]])


def _spray_colours(photo: Picture, cover: Opacity, index: Indices, across_px: float) -> Picture:
    """Mean colours (n, 3) about some places (n,), flat, of the pixels of a photo, by their cover (h, w)."""
    side = max(1, round(SPRAY * across_px))
    weighted = cv2.multiply(photo.astype(np.float32), cv2.merge([cover] * 3))
    total, share = (np.asarray(cv2.blur(part, (side, side))) for part in (weighted, cover))
    mean = total.reshape(-1, 3)[index] / np.maximum(share.ravel()[index], np.float32(1e-4))[:, None]
    return np.clip(np.rint(mean), 0, 255).astype(np.uint8)


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
