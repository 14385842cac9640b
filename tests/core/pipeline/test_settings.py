from dataclasses import fields

import numpy as np
import pytest

from treestroke.core.errors import SettingsError
from treestroke.core.pipeline.settings import MAX_SEED, check_seed, settings_from


def test_nothing_given_means_the_defaults() -> None:
    plain = settings_from({})
    assert (plain.height, plain.library, plain.iterations, plain.variants) == (10.0, "auto", 300, 1)
    assert (plain.species, plain.season, plain.foliage) == ("auto", "photo", "auto")
    assert (plain.wind, plain.lod, plain.compress, plain.files) == ("none", "none", False, ())


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("height", 0.1, 150), ("iterations", 0, 2000), ("variants", 1, 16), ("leaf_size", 0.3, 3), ("leaf_density", 0, 3)],
)
def test_numbers_are_held_to_their_range(name: str, low: float, high: float) -> None:
    step = 1 if name in ("iterations", "variants") else 0.01
    for allowed in (low, high):
        assert getattr(settings_from({name: allowed}), name) == allowed
    for beyond in (low - step, high + step):
        with pytest.raises(SettingsError, match=f"^{name}: .* give .*from {low:g} to {high:g}$"):
            settings_from({name: beyond})


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, "5", None, [5]])
@pytest.mark.parametrize("name", ["height", "iterations"])
def test_what_is_no_number_is_refused(name: str, value: object) -> None:
    with pytest.raises(SettingsError, match=f"^{name}: "):
        settings_from({name: value})


def test_iterations_are_whole() -> None:
    with pytest.raises(SettingsError, match="whole number"):
        settings_from({"iterations": 2.5})


@pytest.mark.parametrize(("name", "value"), [("library", "type3"), ("foliage", "Leaves"), ("library", 1)])
def test_a_choice_is_one_of_its_names(name: str, value: object) -> None:
    with pytest.raises(SettingsError, match=f"^{name}: .*auto, "):
        settings_from({name: value})


def test_an_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SettingsError, match=r"^gust: .*height, library, .*, leaf_density, wind, lod, compress, files$"):
        settings_from({"gust": 1})


def test_values_take_their_setting_s_own_type() -> None:
    settings = settings_from({"height": np.float32(12), "iterations": np.int64(5), "compress": np.True_, "files": []})
    for field in fields(settings):
        assert type(getattr(settings, field.name)) is type(field.default)


def test_several_are_taken_once_each_in_their_own_order() -> None:
    assert settings_from({"files": ["swc", "obj", "swc"]}).files == ("obj", "swc")


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("compress", "yes", "true or false"),
        ("compress", 1, "true or false"),
        ("files", "obj", "any of gltf, obj"),
        ("files", ["fbx"], "any of gltf, obj"),
        ("files", [["obj"]], "any of gltf, obj"),
        ("wind", "storm", "none, breeze, all"),
        ("species", "palm", "auto, ash, beech"),
    ],
)
def test_other_kinds_say_what_they_allow(name: str, value: object, allowed: str) -> None:
    with pytest.raises(SettingsError, match=f"^{name}: .* is not allowed; give {allowed}"):
        settings_from({name: value})


@pytest.mark.parametrize("seed", [0, MAX_SEED, np.int64(7)])
def test_a_seed_in_range_is_taken(seed: int) -> None:
    assert check_seed(seed) == seed


@pytest.mark.parametrize("seed", [-1, MAX_SEED + 1, 1.0, "1", True, None])
def test_another_seed_is_refused(seed: object) -> None:
    with pytest.raises(SettingsError, match="^seed: "):
        check_seed(seed)


@pytest.mark.parametrize(
    ("values", "code", "pointer"),
    [
        ({"gust": 1}, "unknown_setting", "/gust"),
        ({"w/ind\n": 1}, "unknown_setting", r"/w~1ind\n"),
        ({"height": 1000}, "setting_not_allowed", "/height"),
        ({"height": float("inf")}, "non_finite_number", "/height"),
        ({"height": 10**5000}, "setting_not_allowed", "/height"),
        ({"iterations": 2.5}, "setting_not_allowed", "/iterations"),
        ({"foliage": ["moss"] * 1000}, "setting_not_allowed", "/foliage"),
    ],
)
def test_a_refusal_says_what_and_where_for_programs(values: dict[str, object], code: str, pointer: str) -> None:
    with pytest.raises(SettingsError) as refused:
        settings_from(values)
    assert (refused.value.code, refused.value.pointer) == (code, pointer)
    assert len(str(refused.value)) < 240


@pytest.mark.parametrize("seed", [-1, [10**5000], float("nan")])
def test_a_seed_s_refusal_has_its_own_code(seed: object) -> None:
    with pytest.raises(SettingsError) as refused:
        check_seed(seed)
    assert (refused.value.code, refused.value.pointer) == ("seed_invalid", "/seed")
