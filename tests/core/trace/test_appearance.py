import numpy as np
import pytest
from tests.pictures import GROUND, WOOD, noisy, wood_mask, wood_photo

from treestroke.core.imaging.mixture import Mixture
from treestroke.core.trace.appearance import Surroundings, wood_odds

LINE = np.array([[100.0, 180.0], [100.0, 20.0]])
TRUNK = wood_mask([(LINE, 14.0)], 200, 200)
LEAF = (70, 120, 40)


def around(colour: tuple[int, int, int], deviation: float = 8.0) -> Mixture:
    return Mixture(np.ones(1), np.array([colour], float), np.eye(3)[None] * deviation**2)


LEAVES = around(LEAF, 20.0)
BEHIND = around(GROUND)
EVERYWHERE = np.ones((200, 200), dtype=bool)
AROUND = Surroundings(LEAVES, BEHIND, EVERYWHERE, EVERYWHERE)


def test_wood_under_a_line_differs_from_its_ground() -> None:
    odds = wood_odds(wood_photo(TRUNK), [LINE], 2.0, AROUND).by_crown
    assert (odds[TRUNK] > 0).mean() > 0.98
    assert (odds[~TRUNK] < 0).mean() > 0.98


def test_like_wood_elsewhere_is_seen_too() -> None:
    wood = TRUNK | wood_mask([([(30, 150), (60, 30)], 10.0)], 200, 200)
    odds = wood_odds(wood_photo(wood), [LINE], 2.0, AROUND).by_crown
    assert (odds[wood & ~TRUNK] > 0).mean() > 0.95


def test_leaves_that_the_line_crosses_are_not_wood() -> None:
    flat = np.where(TRUNK[..., None], WOOD, GROUND)
    flat[60:110] = LEAF
    odds = wood_odds(noisy(flat), [LINE], 2.0, AROUND).by_crown
    assert (odds[60:110] < 0).mean() > 0.95
    assert (odds[120:170][TRUNK[120:170]] > 0).mean() > 0.95


def test_a_line_over_nothing_but_leaves_finds_no_wood() -> None:
    photo = noisy(np.full((200, 200, 3), LEAF))
    assert (wood_odds(photo, [LINE], 2.0, AROUND).by_crown == -6.0).all()


def test_below_the_crown_a_trunk_of_its_leaves_colour_is_seen_against_the_ground() -> None:
    dark = np.where(TRUNK[..., None], LEAF, GROUND)
    crown = np.zeros((200, 200), dtype=bool)
    crown[:100] = True
    odds = wood_odds(noisy(dark), [LINE], 2.0, Surroundings(LEAVES, BEHIND, crown, crown)).by_crown
    assert (odds[:100] < 0).all()
    assert (odds[100:][TRUNK[100:]] > 0).mean() > 0.95


@pytest.mark.parametrize("line", [LINE, LINE + np.array([95.0, 0.0]), LINE[:1].repeat(2, axis=0)])
def test_odds_are_bounded_wherever_the_line_runs(line: np.ndarray) -> None:
    odds = wood_odds(wood_photo(TRUNK), [line], 3.0, AROUND).by_crown
    assert odds.shape == (200, 200)
    assert np.abs(odds).max() <= 6.0


def test_in_the_crown_wood_of_the_bare_trunk_s_colour_is_seen_where_no_stroke_runs() -> None:
    crown = np.zeros((200, 200), dtype=bool)
    crown[:110] = True
    limb = wood_mask([([(100, 100), (30, 30)], 9.0)], 200, 200)
    flat = np.where(crown[..., None], LEAF, GROUND)
    flat[(TRUNK & ~crown) | limb] = WOOD
    odds = wood_odds(noisy(flat), [LINE], 2.0, Surroundings(LEAVES, BEHIND, crown, crown)).by_crown
    assert (odds[limb & crown] > 0).mean() > 0.95
    assert (odds[crown & ~limb] < 0).mean() > 0.95


def test_wood_in_another_light_is_learnt_in_the_crown() -> None:
    crown = np.zeros((200, 200), dtype=bool)
    crown[:110] = True
    light = np.linspace(-40.0, 40.0, 200)[None, :, None] * np.array([1.0, 0.9, 0.8])
    limb = wood_mask([([(10, 60), (190, 60)], 12.0)], 200, 200)
    flat = np.where(crown[..., None], (200, 150, 30), GROUND) + np.zeros((200, 200, 1))
    wood = (TRUNK & ~crown) | limb
    flat[wood] = np.broadcast_to(np.array([90, 75, 65]) + light, flat.shape)[wood]
    surroundings = Surroundings(around((200, 150, 30), 20.0), BEHIND, crown, crown)
    odds = wood_odds(noisy(flat), [np.array([[100.0, 180.0], [100.0, 115.0]])], 2.0, surroundings).by_crown
    assert (odds[limb] > 0).mean() > 0.9
    assert (odds[crown & ~limb] < 0).mean() > 0.95


def test_on_a_bare_tree_all_but_the_ground_is_wood() -> None:
    crown = np.zeros((200, 200), dtype=bool)
    crown[:110] = True
    twigs = TRUNK | wood_mask([([(100, 100), (30, 30)], 6.0), ([(100, 90), (170, 20)], 6.0)], 200, 200)
    odds = wood_odds(wood_photo(twigs), [LINE], 2.0, Surroundings(None, BEHIND, crown, twigs & crown))
    assert (odds.by_strokes[twigs] > 0).mean() > 0.95
    assert (odds.by_crown[twigs] > 0).mean() > 0.95
    assert (odds.by_crown[~twigs] < 0).mean() > 0.95
