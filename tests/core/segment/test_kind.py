from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.pictures import disc, leaves_on_sky, ring, wood_mask, wood_photo

from treestroke.codec.image import decode_photo
from treestroke.core.segment.foliage import segment_foliage
from treestroke.core.segment.kind import UNSURE, foliage_kind, foliage_look
from treestroke.core.types import FoliageKind
from treestroke.service.loading import load_strokes

DULL, VIVID = (50, 62, 40), (90, 150, 40)
TRUNK = np.array([[150.0, 290.0], [150.0, 200.0], [150.0, 60.0]])
SHORT_TRUNK = np.array([[150.0, 290.0], [150.0, 230.0]])


def kind_of(photo: np.ndarray, mask: np.ndarray, crown: np.ndarray, trunk: np.ndarray) -> FoliageKind:
    return foliage_kind(foliage_look(photo, mask, crown)[0], mask, trunk)


def spire(half_width: float = 55.0) -> np.ndarray:
    picture = np.zeros((300, 300), np.uint8)
    corners = np.array([[150, 20], [150 - half_width, 260], [150 + half_width, 260]], np.int32)
    return cv2.fillPoly(picture, [corners], 1) > 0


def fan(twigs: int = 25) -> np.ndarray:
    ends = ring(120, (150.0, 150.0), twigs)
    return wood_mask([([(150, 150), tuple(end)], 2.0) for end in ends], 300, 300)


@pytest.mark.parametrize(
    ("mask", "colour", "trunk", "kind"),
    [
        (spire(), DULL, TRUNK, "needles"),
        (spire(), VIVID, TRUNK, "leaves"),
        (spire(), DULL, SHORT_TRUNK, "leaves"),
        (disc(300, 110), DULL, TRUNK, "leaves"),
        (disc(300, 110), (200, 60, 40), TRUNK, "leaves"),
    ],
    ids=["dull spire", "vivid spire", "spire without leader", "dull ball", "red ball"],
)
def test_colour_and_shape_tell_needles_from_leaves(
    mask: np.ndarray, colour: tuple[int, int, int], trunk: np.ndarray, kind: str
) -> None:
    assert kind_of(leaves_on_sky(mask, colour), mask, mask, trunk) == kind


def test_a_leaning_trunk_bears_no_needles() -> None:
    leaning = TRUNK + np.array([[0, 0], [30, 0], [60, 0]])
    assert kind_of(leaves_on_sky(spire(), DULL), spire(), spire(), leaning) == "leaves"


def test_a_fan_of_twigs_is_bare() -> None:
    assert kind_of(wood_photo(fan()), fan(), disc(300, 125), TRUNK) == "bare"


def test_no_foliage_at_all_is_bare() -> None:
    none = np.zeros((300, 300), dtype=bool)
    assert kind_of(wood_photo(none), none, disc(300, 125), TRUNK) == "bare"


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
    "loblolly_pines.tree3": "needles",
    "ponderosa_slope": "needles",
    "redbud_park": "leaves",
    "silver_maple_row.tree1": "leaves",
    "silver_maple_row.tree2": "leaves",
    "silver_maple_row.tree3": "needles",
    "white_ash_street": "leaves",
}


@pytest.mark.parametrize(("name", "kind"), KINDS.items())
def test_each_photo_s_kind_is_seen(name: str, kind: str) -> None:
    folder: Path = next(place for place in (EXAMPLES, DATA) if (place / f"{name}.strokes.json").exists())
    photo = decode_photo((folder / f"{name.split('.')[0]}.jpg").read_bytes(), name)
    strokes = load_strokes(folder / f"{name}.strokes.json")
    found = segment_foliage(photo, strokes.crown.points)
    assert foliage_kind(found.look, found.mask, strokes.branches[0].points) == kind


def test_the_judgement_is_as_sure_as_its_cues_are_clear() -> None:
    _, sure = foliage_look(leaves_on_sky(disc(300, 110), VIVID), disc(300, 110), disc(300, 120))
    _, bluish = foliage_look(leaves_on_sky(disc(300, 110), (60, 70, 110)), disc(300, 110), disc(300, 120))
    _, bare = foliage_look(wood_photo(fan()), fan(), disc(300, 125))
    assert sure > 0.8
    assert bluish == 0.0
    assert bare > UNSURE


@pytest.mark.parametrize(
    ("name", "unsure"), [("bigleaf_maple_bare", True), ("beech_round", False), ("elm_house", False)]
)
def test_a_photo_near_the_limit_is_unsure(name: str, unsure: bool) -> None:
    photo = decode_photo((DATA / f"{name}.jpg").read_bytes(), name)
    foliage = segment_foliage(photo, load_strokes(DATA / f"{name}.strokes.json").crown.points)
    assert (foliage.sureness < UNSURE) == unsure
