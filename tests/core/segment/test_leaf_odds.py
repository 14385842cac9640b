import numpy as np

from treestroke.core.imaging.mixture import Mixture, join_mixtures, log_density
from treestroke.core.segment.leaf_odds import BANDS, log_odds_by_height, weights_by_height

LEAF, SKY, HAZE = (60, 120, 30), (200, 210, 230), (70, 125, 60)


def lone(colour: tuple[int, int, int]) -> Mixture:
    return Mixture(np.ones(1), np.array([colour], float), np.eye(3)[None] * 60.0)


def scene() -> tuple[np.ndarray, np.ndarray]:
    """Sky above and hazy trees below, a crown in the middle."""
    pixels = np.empty((100, 80, 3), np.uint8)
    pixels[:60], pixels[60:] = SKY, HAZE
    crown = np.zeros((100, 80), bool)
    crown[10:90, 30:50] = True
    pixels[crown] = LEAF
    return pixels, crown


def test_components_weigh_most_at_the_height_where_they_are_seen() -> None:
    pixels, crown = scene()
    weights = weights_by_height(join_mixtures([lone(SKY), lone(HAZE)], [0.6, 0.4]), pixels, ~crown)
    assert np.allclose(weights.sum(axis=1), 1.0)
    assert weights[0, 0] > 0.8
    assert weights[-1, 1] > 0.7


def test_a_hazy_tree_is_ground_at_the_height_of_the_hazy_trees() -> None:
    pixels, crown = scene()
    pixels[20:24, 38:42] = pixels[80:84, 38:42] = (66, 123, 47)
    odds = log_odds_by_height(lone(LEAF), join_mixtures([lone(SKY), lone(HAZE)], [0.6, 0.4]), pixels, crown)
    assert odds[82, 40] < odds[22, 40] - 0.5


def test_where_nothing_is_seen_the_weights_are_the_mixtures_own() -> None:
    pixels, crown = scene()
    mixture = join_mixtures([lone(SKY), lone(HAZE)], [0.6, 0.4])
    assert weights_by_height(mixture, pixels, np.zeros_like(crown)).tolist() == [[0.6, 0.4]] * BANDS


def test_one_component_each_makes_height_irrelevant() -> None:
    pixels, crown = scene()
    odds = log_odds_by_height(lone(LEAF), lone(SKY), pixels, crown)
    colours = np.array([[60, 124, 28]], float)  # the centre of the look-up cell that holds LEAF
    known = log_density(lone(LEAF), colours) - log_density(lone(SKY), colours)
    assert np.allclose(odds[crown], np.clip(known, -8, 8))
