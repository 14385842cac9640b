"""Tests of siblings: other trees of the same kind as a grown one."""

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.kinship import apart, features
from tests.pictures import overlap

from treestroke.core.geometry.silhouette import silhouette
from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.finishing import finish
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.siblings import Example, grow_sibling, learn
from treestroke.core.pipeline.sketching import grow_sketches, read_sketches
from treestroke.core.pipeline.taken import Taken
from treestroke.core.siblings.outlines import SHAPES, Envelope
from treestroke.service.loading import load_photo, load_sketch, load_strokes

SETTINGS = ModelSettings(iterations=100)


@cache
def example(name: str) -> Example:
    """Grow a tree of a photo among the tests' data, and learn from it."""
    photo = DATA / name
    evidence = read_photo(load_photo(photo.with_suffix(".jpg")), load_strokes(photo.with_suffix(".strokes.json")))
    return learn(grow_tree(evidence, SETTINGS, np.random.default_rng(0)), "photo")


@cache
def sibling(name: str, seed: int) -> GrownTree:
    return grow_sibling(example(name), SETTINGS, np.random.default_rng(seed))


def test_siblings_are_alike_and_those_of_another_kind_are_not() -> None:
    one, other = features(sibling("ash_03", 1).grown.skeleton), features(sibling("ash_03", 2).grown.skeleton)
    pine = features(sibling("ponderosa_slope", 1).grown.skeleton)
    assert 0.03 < apart(one, other) < 0.5 * min(apart(one, pine), apart(other, pine))


def test_a_sibling_is_about_as_high_as_its_example_and_has_its_kind() -> None:
    old, new = example("ponderosa_slope").tree, sibling("ponderosa_slope", 1)
    assert new.stature.height == pytest.approx(old.stature.height, rel=0.15)
    assert new.taken == old.taken


def test_the_same_seed_gives_the_same_sibling() -> None:
    again = grow_sibling(example("ash_03"), SETTINGS, np.random.default_rng(1))
    assert np.array_equal(again.grown.skeleton.points, sibling("ash_03", 1).grown.skeleton.points)


@pytest.mark.parametrize("shape", ["heart", "triangle"])
def test_a_sibling_fills_an_outline(shape: str) -> None:
    rng = np.random.default_rng(3)
    grown = grow_sibling(example("ash_03"), SETTINGS, rng, envelope=Envelope(SHAPES[shape]))
    tree = finish(grown, SETTINGS, rng)
    shown = silhouette(tree.bark, tree.leaf, tree.camera, 400)
    wanted = cv2.resize(tree.expected[0].mask.astype(np.float32), shown.shape[::-1], interpolation=cv2.INTER_AREA)
    assert overlap(shown, wanted[:, : shown.shape[1]] >= 0.5) > 0.85


def test_a_sketched_tree_has_siblings_too() -> None:
    front = load_sketch(EXAMPLES / "sketches" / "pear.front.json", "front")
    tree = grow_sketches(read_sketches(front), SETTINGS, np.random.default_rng(0))
    rng = np.random.default_rng(1)
    grown = grow_sibling(learn(tree, "photo"), SETTINGS, rng)
    assert finish(grown, SETTINGS, rng).leaf is not None


def test_a_palm_s_sibling_has_fronds() -> None:
    tree = example("ponderosa_slope").tree
    palm = learn(replace(tree, taken=Taken("palm", "round", 1.0)), "photo")
    grown = grow_sibling(palm, SETTINGS, np.random.default_rng(0)).grown
    assert len(grown.skeleton) > 50
