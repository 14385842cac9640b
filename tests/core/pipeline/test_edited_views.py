import numpy as np
import pytest
from tests.core.pipeline.test_viewing import evidence
from tests.core.pipeline.walked_capture import HEIGHT

from treestroke.core.pipeline.edited_views import at_height, edited_views, with_edits
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.viewing import live_views
from treestroke.core.skeleton.branch_edits import Add, Remove


def limb() -> Add:
    """Add a branch from the top of what is seen of the trunk into the crown, in the structure's frame."""
    points = np.array([evidence().seen.skeleton.points[-1], [0.0, 2.5, 0.0], [0.3, 3.8, 0.2]])
    placed = evidence().frame.inverse.points(points)
    return Add(placed[0], placed[1:])


def test_another_height_scales_everything_that_was_read() -> None:
    higher = at_height(evidence(), 3 * HEIGHT)
    assert np.allclose(higher.seen.skeleton.points, 3 * evidence().seen.skeleton.points)
    assert np.allclose(higher.crown.bounds, 3 * evidence().crown.bounds)
    assert higher.crown.densities.sum() == pytest.approx(evidence().crown.densities.sum() / 3, rel=1e-4)
    points = evidence().cloud.points[:9]
    for before, after in zip(evidence().shots, higher.shots, strict=True):
        assert np.allclose(after.camera.pixels_from_world(3 * points), before.camera.pixels_from_world(points))
    assert np.allclose(
        higher.frame.points(evidence().structure.cloud.points[:9]),
        3 * evidence().frame.points(evidence().structure.cloud.points[:9]),
    )
    assert at_height(evidence(), HEIGHT) is evidence()


def test_edits_are_in_the_structure_s_frame_and_those_that_are_lost_are_told() -> None:
    found = edited_views(evidence(), [limb(), Remove(np.full(3, 99.0))])
    assert np.allclose(found.seen.skeleton.points[-1], [0.3, 3.8, 0.2])
    assert not found.seen.seen[-1]
    lost = [warning for warning in found.warnings if warning.code == "edit_lost"]
    assert [warning.stroke for warning in lost] == ["edits/1"]
    assert "there is no branch near" in lost[0].detail


def test_what_is_added_grows() -> None:
    settings = ModelSettings(iterations=3)
    before, after = (
        live_views(edited_views(evidence(), edits), settings, np.random.default_rng(0)).skeleton
        for edits in ([], [limb()])
    )
    assert after.points[:, 1].max() > before.points[:, 1].max() + 2.0


def test_a_model_has_the_branches_that_were_traced_and_edited() -> None:
    """Evidence at another height stands in for that of larger pictures."""
    traced, larger = evidence(), at_height(evidence(), 2 * HEIGHT)
    found = with_edits(larger, traced, [limb(), Remove(np.full(3, 99.0))])
    seen = edited_views(traced, [limb()]).seen
    assert np.allclose(found.seen.skeleton.points, 2 * seen.skeleton.points)
    assert np.allclose(found.seen.skeleton.radii, 2 * seen.skeleton.radii)
    assert np.array_equal(found.seen.skeleton.points[0], np.zeros(3))
    assert np.array_equal(found.seen.leaf_points, larger.seen.leaf_points)
    assert [warning.code for warning in found.edited] == ["edit_lost"]
