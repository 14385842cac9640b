import pytest

from treestroke.core.pipeline.settings import ModelSettings
from treestroke.service.progress_estimate import ProgressEstimate, model_phases

SEEING = ["decode", "foliage", "trace"]
GROWING = ["lift", "grow", "leaf", "mesh"]


def walked(settings: ModelSettings, phases: list[str]) -> list[float]:
    estimate = ProgressEstimate(model_phases(settings, "photo"))
    return [estimate.progress(phase, fraction) for phase in phases for fraction in (0.0, 0.5, 1.0)]


@pytest.mark.parametrize("variants", [1, 3])
@pytest.mark.parametrize("lod", ["none", "files"])
def test_progress_rises_from_nothing_to_all(variants: int, lod: str) -> None:
    each = [*GROWING, *(["levels"] if lod == "files" else []), "write"]
    told = walked(ModelSettings(variants=variants, lod=lod), [*SEEING, *(each * variants), "preview"])
    assert told == sorted(told)
    assert (told[0], told[-1]) == (0.0, pytest.approx(1.0))


def test_the_progress_of_sketches_rises_from_nothing_to_all() -> None:
    estimate = ProgressEstimate(model_phases(ModelSettings(), "sketches"))
    phases = ["decode", "trace", *GROWING, "write", "preview"]
    told = [estimate.progress(phase, fraction) for phase in phases for fraction in (0.0, 0.5, 1.0)]
    assert told == sorted(told)
    assert (told[0], told[-1]) == (0.0, pytest.approx(1.0))


def test_the_second_of_two_trees_begins_after_the_first() -> None:
    estimate = ProgressEstimate(model_phases(ModelSettings(variants=2), "photo"))
    first = [estimate.progress(phase, 1.0) for phase in [*SEEING, *GROWING, "write"]][-1]
    assert estimate.progress("lift", 0.0) == pytest.approx(first)
    assert estimate.progress("write", 1.0) > 0.8


def test_more_to_write_leaves_more_to_do() -> None:
    plain, rich = (
        ProgressEstimate(model_phases(s, "photo"))
        for s in (ModelSettings(), ModelSettings(lod="files", compress=True, files=("obj",)))
    )
    assert rich.progress("mesh", 1.0) < 0.6 * plain.progress("mesh", 1.0)


def test_a_phase_that_nobody_knows_changes_nothing() -> None:
    estimate = ProgressEstimate(model_phases(ModelSettings(), "photo"))
    before = estimate.progress("grow", 0.0)
    assert estimate.progress("dance", 0.0) == before
