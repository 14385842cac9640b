"""Frames along space curves that do not spin."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats


def rotation_minimizing_normals(points: Floats, tangents: Floats, first: NDArray[np.int64], seeds: Floats) -> Floats:
    """Carry a normal along each of k curves without turning it about the curve.

    All curves go one step at a time together, so the loop is as long as the longest curve.

    Parameters
    ----------
    points, tangents
        (m, 3) the curves' points, one curve after the other, and their unit tangents.
    first
        (k,) ascending index of each curve's first point; ``first[0]`` is 0.
    seeds
        (k, 3) wished normal at each curve's start; made perpendicular to the tangent there, and replaced
        by an axis of the frame where it is parallel to it.

    Returns
    -------
    (m, 3) unit normals, perpendicular to ``tangents``.

    Notes
    -----
    Double reflection: Wang, Juettler, Zheng and Liu, "Computation of Rotation Minimizing Frames", 2008,
    table I. Where two points coincide only the tangent's reflection is left.
    """
    normals = np.empty_like(points)
    normals[first] = _perpendicular(seeds, tangents[first])
    lengths = np.diff(np.append(first, len(points)))
    longest_first = np.argsort(-lengths, kind="stable")
    running = np.searchsorted(np.sort(lengths), np.arange(1, lengths.max(initial=1)), side="right")
    for step, ended in enumerate(running.tolist()):
        before = first[longest_first[: len(first) - ended]] + step
        after = before + 1
        chord = points[after] - points[before]
        normal, tangent = _reflected(normals[before], chord), _reflected(tangents[before], chord)
        normals[after] = _perpendicular(_reflected(normal, tangents[after] - tangent), tangents[after])
    return normals


def _reflected(vectors: Floats, mirrors: Floats) -> Floats:
    """Mirror vectors (n, 3) in the planes with normals ``mirrors``; a zero mirror leaves its vector."""
    squared = np.einsum("ij,ij->i", mirrors, mirrors)
    share = 2.0 * np.einsum("ij,ij->i", vectors, mirrors) / np.where(squared > 1e-24, squared, np.inf)
    return np.asarray(vectors - share[:, None] * mirrors)


def _perpendicular(vectors: Floats, tangents: Floats) -> Floats:
    """Take the tangent out of vectors (n, 3) and make them unit."""
    out = vectors - np.einsum("ij,ij->i", vectors, tangents)[:, None] * tangents
    lost = np.linalg.norm(out, axis=1) < 1e-6
    if lost.any():
        axis = np.eye(3)[np.argmin(np.abs(tangents[lost]), axis=1)]
        out[lost] = axis - np.einsum("ij,ij->i", axis, tangents[lost])[:, None] * tangents[lost]
    return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))
