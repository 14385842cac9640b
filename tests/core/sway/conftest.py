"""A tree grown from a photo, and the wind in it."""

from pathlib import Path

import pytest

import treestroke
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.sway.motion import Motion
from treestroke.core.sway.wind import wind_of


@pytest.fixture(scope="session")
def maple(maple_photo: Path, maple_strokes: Path) -> TreeModel:
    return treestroke.model(maple_photo, maple_strokes, {}).tree


@pytest.fixture(scope="session")
def blown(maple: TreeModel) -> Motion:
    return wind_of(maple.grown.skeleton, ("breeze", "gust"), maple.cards.joints)
