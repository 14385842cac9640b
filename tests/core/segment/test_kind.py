from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.pictures import disc, ring, wood_mask, wood_photo

from treestroke.codec.image import decode_photo
from treestroke.core.pipeline.taken import ASK_BELOW
from treestroke.core.segment.cues import crown_cues
from treestroke.core.segment.foliage import segment_foliage
from treestroke.core.segment.kind import KindOdds, kind_odds, likeliest
from treestroke.service.loading import load_strokes

TRUNK = np.array([[150.0, 290.0], [150.0, 200.0]])


def odds_of(photo: np.ndarray, mask: np.ndarray, crown: np.ndarray) -> KindOdds:
    """Judge a crown on a trunk that ends at row 290."""
    outline, _ = cv2.findContours(crown.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return kind_odds(crown_cues(photo, mask, crown), outline[0][:, 0].astype(np.float64), TRUNK)


def photo_odds(name: str, size: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)) -> KindOdds:
    """Judge a photo of the tests or examples at another size, or with its crown's stroke shifted (px)."""
    folder: Path = next(place for place in (EXAMPLES, DATA) if (place / f"{name}.strokes.json").exists())
    photo = decode_photo((folder / f"{name.split('.')[0]}.jpg").read_bytes(), name)
    photo = cv2.resize(photo, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
    strokes = load_strokes(folder / f"{name}.strokes.json")
    crown, trunk = (strokes.crown.points + shift) * size, strokes.branches[0].points * size
    return kind_odds(segment_foliage(photo, crown).cues, crown, trunk)


def fan(twigs: int = 25) -> np.ndarray:
    ends = ring(120, (150.0, 150.0), twigs)
    return wood_mask([([(150, 150), tuple(end)], 2.0) for end in ends], 300, 300)


def test_the_odds_of_all_kinds_together_are_one() -> None:
    odds = odds_of(wood_photo(fan()), fan(), disc(300, 125))
    assert sum(odds.values()) == pytest.approx(1.0)
    assert min(odds.values()) >= 0.0


KINDS = {
    "burr_oak_dusk": "leaves",
    "oak_02": "leaves",
    "osage_orange_autumn": "leaves",
    "sugar_maple_autumn": "leaves",
    "beech_round": "leaves",
    "bigleaf_maple_bare": "bare",
    "boxelder_lawn": "leaves",
    "cherry_blossom": "leaves",
    "elm_house": "leaves",
    "loblolly_pines.tree1": "needles",
    "loblolly_pines.tree2": "needles",
    "ponderosa_slope": "needles",
    "redbud_park": "leaves",
    "silver_maple_row.tree1": "leaves",
    "silver_maple_row.tree2": "leaves",
    "silver_maple_row.tree3": "needles",
    "white_ash_street": "leaves",
}


@pytest.mark.parametrize(("name", "kind"), KINDS.items())
def test_each_photo_s_kind_is_seen(name: str, kind: str) -> None:
    assert likeliest(photo_odds(name)) == kind


def test_a_pine_that_stands_before_others_is_asked_about() -> None:
    odds = photo_odds("loblolly_pines.tree3")
    assert max(odds.values()) < ASK_BELOW
    assert odds["needles"] > 0.35


@pytest.mark.parametrize(("name", "kind"), [("ponderosa_slope", "needles"), ("bigleaf_maple_bare", "bare")])
def test_the_kind_holds_at_half_the_size_and_with_the_stroke_a_little_beside(name: str, kind: str) -> None:
    assert likeliest(photo_odds(name, size=0.5)) == kind
    assert likeliest(photo_odds(name, shift=(8.0, -6.0))) == kind


def test_a_fan_of_twigs_is_bare() -> None:
    assert likeliest(odds_of(wood_photo(fan()), fan(), disc(300, 125))) == "bare"


@pytest.mark.parametrize("colour", [(80, 130, 50), (220, 180, 30)])
def test_twigs_with_few_leaves_are_hardly_bare(colour: tuple[int, int, int]) -> None:
    photo, mask = wood_photo(fan()), fan()
    rng = np.random.default_rng(4)
    rows, columns = np.nonzero(mask)
    for place in rng.choice(len(rows), 160, replace=False):
        leaf = np.s_[rows[place] - 3 : rows[place] + 3, columns[place] - 3 : columns[place] + 3]
        photo[leaf], mask[leaf] = colour, True
    leafy, bare = odds_of(photo, mask, disc(300, 125)), odds_of(wood_photo(fan()), fan(), disc(300, 125))
    assert leafy["bare"] < 0.5 < bare["bare"]


def ball_of_leaves(colour: tuple[int, int, int]) -> KindOdds:
    """Judge a ball of square leaves, 4 px wide, whose outline they break."""
    rng = np.random.default_rng(0)
    light, out_px = (np.kron(rng.uniform(low, high, (75, 75)), np.ones((4, 4))) for low, high in ((0.5, 1.1), (-9, 9)))
    rows, columns = np.mgrid[:300, :300]
    ball = np.hypot(rows - 150, columns - 150) < 105 + out_px
    leaves = np.rint(np.array(colour) * light[..., None]).astype(np.uint8)
    photo = np.where(ball[..., None], leaves, np.array([150, 190, 230], dtype=np.uint8))
    return odds_of(photo, ball, disc(300, 115))


def test_a_ball_of_vivid_leaves_is_surely_in_leaf() -> None:
    assert ball_of_leaves((90, 150, 40))["leaves"] > 0.9


def test_bluish_foliage_is_less_surely_leaves() -> None:
    vivid, bluish = ball_of_leaves((90, 150, 40)), ball_of_leaves((60, 70, 110))
    assert bluish["leaves"] < vivid["leaves"] - 0.1
    assert bluish["bare"] > vivid["bare"]


@pytest.mark.parametrize(("name", "least", "most"), [("beech_round", 0.8, 1.0), ("loblolly_pines.tree1", 0.2, 0.8)])
def test_a_photo_is_judged_as_surely_as_its_cues_are_clear(name: str, least: float, most: float) -> None:
    assert least <= max(photo_odds(name).values()) <= most
