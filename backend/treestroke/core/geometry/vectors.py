"""Unit vectors, and frames along curves that do not twist."""

import numpy as np

from treestroke.core.types import Floats, Indices

UP = np.array([0.0, 1.0, 0.0])
"""The world's vertical."""


def unit(vectors: Floats, otherwise: Floats | float = 0.0) -> Floats:
    """Scale vectors (..., d) of any unit to length 1; those shorter than 1e-12 become ``otherwise``."""
    # Channel by channel: numpy sums and broadcasts over short axes slowly.
    length = np.sqrt(sum(vectors[..., axis] ** 2 for axis in range(vectors.shape[-1])))[..., None]
    if (length > 1e-12).all():
        return vectors / length
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), otherwise)


def rotation_minimizing_normals(points: Floats, tangents: Floats, first: Indices, seeds: Floats) -> Floats:
    """Carry a normal along each of k curves without turning it about the curve.

    All curves advance one step at a time together, so the loop is as long as the longest curve.

    Parameters
    ----------
    points, tangents
        (m, 3) the curves' points, metres, one curve after the other, and their unit tangents.
    first
        (k,) ascending index of each curve's first point; ``first[0]`` is 0.
    seeds
        (k, 3) preferred normal at each curve's start, any length; its part along the tangent is removed. Where nothing
        is left, the coordinate axis furthest from the tangent takes its place.

    Returns
    -------
    (m, 3) unit normals, perpendicular to ``tangents``.

    Notes
    -----
    Double reflection: Wang, Juettler, Zheng and Liu, "Computation of Rotation Minimizing Frames", 2008,
    table I. Where two points coincide, only the reflection of the tangents is applied.
    """
    normals = np.empty_like(points)
    normals[first] = _perpendicular(seeds, tangents[first])
    lengths = np.diff(np.append(first, len(points)))
    longest_first = np.argsort(-lengths, kind="stable")
    ended_by_step = np.searchsorted(np.sort(lengths), np.arange(1, lengths.max(initial=1)), side="right")
    for step, ended in enumerate(ended_by_step.tolist()):
        before = first[longest_first[: len(first) - ended]] + step
        after = before + 1
        chord = points[after] - points[before]
        normal, tangent = _reflected(normals[before], chord), _reflected(tangents[before], chord)
        normals[after] = _perpendicular(_reflected(normal, tangents[after] - tangent), tangents[after])
    return normals


def _reflected(vectors: Floats, mirrors: Floats) -> Floats:
    """Reflect vectors (n, 3) in the planes with normals ``mirrors`` (n, 3); a zero normal leaves its vector."""
    squared = np.einsum("ij,ij->i", mirrors, mirrors)
    share = 2.0 * np.einsum("ij,ij->i", vectors, mirrors) / np.where(squared > 1e-24, squared, np.inf)
    return np.asarray(vectors - share[:, None] * mirrors)


def _perpendicular(vectors: Floats, tangents: Floats) -> Floats:
    """Remove the part of vectors (n, 3) along unit tangents (n, 3) and scale the rest to length 1."""
    out = vectors - np.einsum("ij,ij->i", vectors, tangents)[:, None] * tangents
    parallel = np.linalg.norm(out, axis=1) < 1e-6
    if parallel.any():
        axis = np.eye(3)[np.argmin(np.abs(tangents[parallel]), axis=1)]
        out[parallel] = axis - np.einsum("ij,ij->i", axis, tangents[parallel])[:, None] * tangents[parallel]
    return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))
