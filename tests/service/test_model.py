import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.conftest import DATA

import treestroke
from treestroke.service.model import Model

QUICK = {"iterations": 5}

STAGES = ("decode", "foliage", "trace", "lift", "grow", "leaf", "mesh", "levels", "write")


@pytest.fixture(scope="module")
def maple(maple_photo: Path, maple_strokes: Path) -> Model:
    return treestroke.model(maple_photo, maple_strokes, QUICK, seed=1)


def test_the_report_has_the_contract_s_fields(maple: Model) -> None:
    report = maple.report
    needed = {"engine", "seed", "settings", "seconds", "counts", "score", "warnings"}
    assert set(report) == needed | {"measures", "variants", "siblings", "files", "reading", "taken"}
    assert set(report["seconds"]) == set(STAGES) - {"levels"}
    assert set(report["counts"]) == {"iterations", "branches", "leaves", "triangles", "bytes"}
    assert set(report["score"]) == {"silhouette_iou", "attractors_reached", "depth_over_width"}
    assert all(type(count) is int for count in report["counts"].values())


def test_every_stage_took_some_time(maple: Model) -> None:
    assert min(maple.report["seconds"].values()) > 0


def test_auto_foliage_is_named(maple: Model) -> None:
    assert maple.report["settings"]["foliage"] == "leaves"


def test_the_report_says_what_the_score_is_measured_against(maple: Model) -> None:
    reading = maple.report["reading"]
    assert reading["against"] == "the foliage and branches as they were read in the photo"
    assert maple.report["taken"]["sureness"] > 0.8
    assert list(reading["doubts"]) == []


@pytest.mark.parametrize(("settings", "doubts"), [({}, ["kind_unsure"]), ({"foliage": "needles"}, [])])
def test_a_tree_that_may_bear_something_else_is_doubted_unless_it_was_said(settings: dict, doubts: list[str]) -> None:
    photo, strokes = DATA / "loblolly_pines.jpg", DATA / "loblolly_pines.tree1.strokes.json"
    report = treestroke.model(photo, strokes, {"iterations": 0, **settings}).report
    assert report["settings"]["foliage"] == report["taken"]["foliage"] == "needles"
    assert report["taken"]["ask"] == bool(doubts)
    assert list(report["reading"]["doubts"]) == doubts


def test_a_bare_tree_is_taken_for_bare() -> None:
    photo, strokes = (DATA / f"bigleaf_maple_bare.{end}" for end in ("jpg", "strokes.json"))
    assert treestroke.model(photo, strokes, {"iterations": 0}).report["taken"]["foliage"] == "bare"


def test_strokes_that_may_mean_no_tree_are_warned_of_and_doubted(maple_photo: Path, maple_strokes: Path) -> None:
    strokes = json.loads(maple_strokes.read_text())
    low, wide = np.min(strokes["crown"]["points"], axis=0), np.ptp(strokes["crown"]["points"], axis=0)[0]
    beside = [[x - low[0] - 0.5 * wide, y] for x, y in strokes["crown"]["points"]]
    strokes = {"crown": {"points": beside}, "branches": [{"points": [[10, 600], [12, 300]]}]}
    report = treestroke.model(maple_photo, strokes, {"iterations": 0}).report
    assert "outside_photo" in [one["code"] for one in report["warnings"]]
    assert "outside_photo" in report["reading"]["doubts"]


def test_the_same_input_gives_the_same_bytes_however_it_is_handed_in(
    maple: Model, maple_photo: Path, maple_strokes: Path
) -> None:
    pixels = treestroke.trace(maple_photo, maple_strokes).photo
    assert treestroke.model(pixels, maple_strokes, treestroke.ModelSettings(**QUICK), 1).glb == maple.glb


def test_another_seed_gives_another_tree(maple: Model, maple_photo: Path, maple_strokes: Path) -> None:
    assert treestroke.model(maple_photo, maple_strokes, QUICK, seed=2).glb != maple.glb


def test_progress_goes_through_the_stages_in_order(maple_photo: Path, maple_strokes: Path) -> None:
    seen: list[tuple[str, float]] = []
    treestroke.model(maple_photo, maple_strokes, QUICK, report=lambda stage, fraction: seen.append((stage, fraction)))
    assert list(dict.fromkeys(stage for stage, _ in seen)) == [stage for stage in STAGES if stage != "levels"]
    assert all(0.0 <= fraction <= 1.0 for _, fraction in seen)


def test_no_stage_falls_back(maple_photo: Path, maple_strokes: Path) -> None:
    told: dict[str, list[float]] = {stage: [] for stage in STAGES if stage != "levels"}
    treestroke.model(maple_photo, maple_strokes, QUICK, report=lambda stage, fraction: told[stage].append(fraction))
    assert all(fractions == sorted(fractions) for fractions in told.values())
    assert min(len(fractions) for fractions in told.values()) >= 1


def test_the_grown_tree_is_shown_once_before_it_has_leaves(maple_photo: Path, maple_strokes: Path) -> None:
    told: list[str] = []

    def show(tree: treestroke.LiveTree) -> None:
        told.append(f"{len(tree.skeleton) == len(tree.born)}")

    treestroke.model(maple_photo, maple_strokes, QUICK, report=lambda stage, _: told.append(stage), on_grown=show)
    assert told.count("True") == 1
    assert told[told.index("True") - 1 : told.index("True") + 2] == ["grow", "True", "leaf"]


def test_an_exception_in_a_report_ends_the_work(maple_photo: Path, maple_strokes: Path) -> None:
    class CancelledError(Exception):
        pass

    def stop(stage: str, _: float) -> None:
        if stage == "decode":
            raise CancelledError

    with pytest.raises(CancelledError):
        treestroke.model(maple_photo, maple_strokes, QUICK, report=stop)


def test_variants_are_the_trees_of_the_next_seeds(maple: Model, maple_photo: Path, maple_strokes: Path) -> None:
    both = treestroke.model(maple_photo, maple_strokes, {**QUICK, "variants": 2}, seed=0)
    assert list(both.files) == ["tree.glb", "tree.v2.glb"]
    assert both.files["tree.v2.glb"] == maple.glb
    first, second = both.report["variants"]
    assert (first["seed"], second["seed"]) == (0, 1)
    assert second["score"] == maple.report["score"]
    assert abs(first["score"]["silhouette_iou"] - second["score"]["silhouette_iou"]) < 0.05


def test_a_known_length_sets_the_height(maple_photo: Path, maple_strokes: Path) -> None:
    strokes = json.loads(maple_strokes.read_text())
    (x, y), top = strokes["branches"][0]["points"][0], min(y for _, y in strokes["crown"]["points"])
    strokes["scale"] = {"points": [[x, y], [x, (y + top) / 2]], "metres": 4.0}
    measures = treestroke.model(maple_photo, strokes, {**QUICK, "height": 100}).report["measures"]
    assert measures["height"]["value"] == pytest.approx(8.0, rel=0.1)
    assert (measures["height"]["basis"], measures["scale"]["basis"]) == ("measured", "measured")


def test_the_preview_is_a_picture(maple: Model) -> None:
    picture = maple.preview()
    assert picture.dtype == np.uint8
    assert picture.std() > 10


def test_strokes_without_a_trunk_are_refused(maple_photo: Path, maple_strokes: Path) -> None:
    crown = treestroke.trace(maple_photo, maple_strokes)
    points = [[0, 0], [crown.photo.shape[1], 0], [300, 400]]
    with pytest.raises(treestroke.StrokesError, match="branches"):
        treestroke.model(maple_photo, {"crown": {"points": points}})


def test_a_tree_of_one_photo_needs_no_library_of_many() -> None:
    heavy = ["scipy", "pycolmap", "sklearn", "pydantic"]
    code = f"import sys, treestroke.service.model; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
