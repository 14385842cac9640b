"""Places leaves on branches, inside the foliage that the views show, until it is covered.

Source: Tan et al. 2008, section 4: cards around the branches in proportion to their length, only those that
project inside the foliage stay. Ours are sprays of several leaves, so that 25,000 of them fill a crown, turned and
shrunk at its outline; what stays uncovered gets further cards from the nearest branch.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from treestroke.core.leaf.arrangement import (
    Poses,
    Seats,
    bare_tips,
    pose_at_tips,
    pose_on_branches,
    seats_along,
)
from treestroke.core.leaf.fronds import set_fronds
from treestroke.core.leaf.gaps import GapParams, cover_gaps
from treestroke.core.leaf.leaf_crown import USUAL_FIT, Fit, LeafCrown
from treestroke.core.leaf.leaf_density import leaf_weights
from treestroke.core.leaf.leaves import Leaves, join_leaves, no_leaves
from treestroke.core.leaf.postures import pose_by_posture, posture_of
from treestroke.core.leaf.shown_limbs import LeafPlace, shown_limbs
from treestroke.core.leaf.view_cover import cover_views
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import CONIFEROUS, FOLIAGE_KINDS, Floats, FoliageKind, Indices, TreeForm

LAYERS = 10.0
"""Cards' opaque area over the foliage's area in the picture, at density 1 (a leaf area index)."""
RESERVE = 0.35
"""Share of the cards reserved for what the first ones leave uncovered."""
SHRINKING = (1.0, 0.8, 0.6, 0.45)
"""Sizes at which a card that does not fit the foliage is tried again, each time with another pose."""
BUD = 0.1
"""Size of a bud relative to a card."""


@dataclass(frozen=True)
class LeafParams:
    """How many cards a tree bears.

    Attributes
    ----------
    density
        Factor on the number of cards, 0 to 3; 0 bears none, under 1 leaves part of the foliage uncovered.
    max_cards
        Most cards besides those at twigs' ends.
    kind
        What the twigs bear; ``bare`` bears nothing.
    form
        How its limbs grow, and its sprays hang.
    """

    density: float = 1.0
    max_cards: int = 25_000
    kind: FoliageKind = "leaves"
    form: TreeForm = "round"

    def __post_init__(self) -> None:
        if not 0 <= self.density <= 3:
            raise ValueError(f"density must be 0 to 3, got {self.density}")
        if self.max_cards < 0 or self.kind not in FOLIAGE_KINDS:
            raise ValueError(f"max_cards must not be negative and kind one of FoliageKind, got {self}")


def place_leaves(
    skeleton: Skeleton,
    crown: LeafCrown,
    params: LeafParams,
    rng: np.random.Generator,
    report: Report = silent,
) -> Leaves:
    """Hang cards on a grown tree (metres) in its crown.

    In every view that sees it, a card's centre projects into the foliage, or onto wood that it lies behind, and its
    leaves at most by a few per cent outside; nearly all cards stand nearer to a branch than 4.5 % of the tree's height.
    Each twig's end bears a card, or a bud (a tiny card) where that would lie outside, or density under 1 leaves none. A
    bare tree or density 0 bears nothing. ``report("leaf", fraction)`` is called.

    Source: Tan et al. 2008, section 4; the module's head says where we differ.
    """
    if params.kind == "bare" or params.density == 0 or params.max_cards == 0:
        return no_leaves()
    if params.kind == "palm":
        return set_fronds(skeleton, crown, params.density, rng)
    wanted = params.density * LAYERS * crown.foliage_area / crown.card_area
    count = round(min((1 - RESERVE) * params.max_cards, wanted))
    grids, even = (*crown.grids, *crown.imagined_sides), params.kind in CONIFEROUS
    weights = leaf_weights(skeleton, grids, crown.volume, crown.height, even)
    place = LeafPlace(crown, shown_limbs(skeleton, crown))
    along = _on_branches(seats_along(skeleton, weights, count, rng), place, params, rng)
    leaves = join_leaves([along, _at_tips(bare_tips(skeleton, along), params.density, place, rng)])
    report("leaf", 0.5)
    gaps = GapParams(min(1.0, params.density), params.max_cards - len(along))
    if crown.seen_around:
        patches = cover_views(leaves, skeleton, crown, gaps, rng)
    else:
        patches = cover_gaps(leaves, skeleton, place, gaps, rng)
    leaves = crown.recoloured(join_leaves([leaves, *patches]), rng)
    report("leaf", 1.0)
    return leaves


def _at_tips(seats: Seats, density: float, place: LeafPlace, rng: np.random.Generator) -> Leaves:
    """Set a card at each twig's end, or at a share of them by the density; a bud where the card does not fit."""
    crown = place.crown

    def pose(seats: Seats, half_sizes: Floats) -> Poses:
        return pose_at_tips(seats, half_sizes, crown.middle, rng)

    leafy = rng.random(len(seats)) < density
    sprays, left = _fitted(seats.at(leafy), pose, place, rng)
    bare = ~leafy
    bare[np.flatnonzero(leafy)[left]] = True
    buds = seats.at(bare)
    return join_leaves([sprays, crown.coloured(pose(buds, BUD * crown.half_sizes(len(buds), rng)), buds, rng)])


def _on_branches(seats: Seats, place: LeafPlace, params: LeafParams, rng: np.random.Generator) -> Leaves:
    """Hang a card on each seat where it fits the foliage."""
    crown, posture = place.crown, posture_of(params.kind, params.form)

    def pose(seats: Seats, half_sizes: Floats) -> Poses:
        if posture is not None:
            return pose_by_posture(seats, half_sizes, crown.middle, posture, rng)
        return pose_on_branches(seats, half_sizes, crown.height, crown.middle, rng)

    return _fitted(seats, pose, place, rng, USUAL_FIT if posture is None else Fit(posture.inside))[0]


def _fitted(
    seats: Seats,
    pose: Callable[[Seats, Floats], Poses],
    place: LeafPlace,
    rng: np.random.Generator,
    fit: Fit = USUAL_FIT,
) -> tuple[Leaves, Indices]:
    """Set a card on each seat; those that do not fit are posed again, smaller each time, a few times, then left out."""
    found, full, order = [], place.crown.half_sizes(len(seats), rng), np.arange(len(seats))
    for scale in SHRINKING:
        if len(order) == 0:
            break
        tried = seats.at(order)
        leaves, kept = place.dressed(pose(tried, scale * full[order]), tried, rng, fit)
        found.append(leaves)
        order = order[~kept]
    return join_leaves(found), order
