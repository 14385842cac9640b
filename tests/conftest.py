"""Real photos for all tests."""

from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.fixture(scope="session")
def maple_photo() -> Path:
    return EXAMPLES / "sugar_maple_autumn.jpg"


@pytest.fixture(scope="session")
def maple_strokes() -> Path:
    return EXAMPLES / "sugar_maple_autumn.strokes.json"
