import pytest

from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.taken import ASK_BELOW, Taken, shown_kind, taken_for

NEEDLES = {"leaves": 0.2, "needles": 0.7, "scales": 0.06, "palm": 0.02, "bare": 0.02}
BARE = {"leaves": 0.3, "needles": 0.05, "scales": 0.0, "palm": 0.0, "bare": 0.65}


def test_auto_takes_the_likeliest_kind_and_is_as_sure_as_the_picture() -> None:
    assert taken_for(NEEDLES, "spire", ModelSettings()) == Taken("needles", "spire", 0.7)


@pytest.mark.parametrize(("settings", "foliage"), [({"foliage": "palm"}, "palm"), ({"season": "bare"}, "bare")])
def test_what_the_settings_say_is_sure(settings: dict, foliage: str) -> None:
    taken = taken_for(NEEDLES, "round", ModelSettings(**settings))
    assert (taken.foliage, taken.sureness, taken.ask) == (foliage, 1.0, False)


def test_the_setting_form_is_taken_before_the_picture_s() -> None:
    assert taken_for(NEEDLES, "spire", ModelSettings(form="weeping")).form == "weeping"


def test_a_bare_tree_that_is_to_have_leaves_has_leaves() -> None:
    assert taken_for(BARE, "round", ModelSettings(season="summer")).foliage == "leaves"
    assert taken_for(BARE, "round", ModelSettings()).foliage == "bare"


def test_a_species_leaves_open_only_whether_it_is_bare() -> None:
    assert taken_for(BARE, "round", ModelSettings(species="oak")) == Taken("bare", "round", 0.65)
    assert taken_for(NEEDLES, "round", ModelSettings(species="oak")) == Taken("leaves", "round", pytest.approx(0.98))
    assert taken_for(BARE, "round", ModelSettings(species="pine")) == Taken("needles", "round", 1.0)


def test_a_person_is_asked_below_the_stated_sureness() -> None:
    assert Taken("leaves", "round", ASK_BELOW - 0.01).ask
    assert not Taken("leaves", "round", ASK_BELOW).ask


def test_the_picture_shows_what_the_settings_say_of_its_own_season() -> None:
    assert shown_kind(BARE, ModelSettings(foliage="leaves")) == "leaves"
    assert shown_kind(BARE, ModelSettings(foliage="leaves", season="summer")) == "bare"
