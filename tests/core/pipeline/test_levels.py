from dataclasses import replace

import numpy as np
import pytest
from tests.builders import stick
from tests.core.pipeline.test_photo import MAPLE, modelled
from tests.levels import level_ious

from treestroke.core.geometry.silhouette import AZIMUTHS_RAD, framing, overlap, silhouette_from
from treestroke.core.leaf.cards import cards
from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.levels import Level, Levels, levels
from treestroke.core.pipeline.settings import ModelSettings


@pytest.fixture(scope="module")
def maple() -> TreeModel:
    return modelled(MAPLE, ModelSettings(iterations=150))


@pytest.fixture(scope="module")
def made(maple: TreeModel) -> Levels:
    return levels(maple)


def triangles(level: Level) -> int:
    return sum(len(surface.mesh.triangles) for surface in level.surfaces)


def test_levels_have_their_shares_of_the_triangles(maple: TreeModel, made: Levels) -> None:
    whole = triangles(Level(maple.bark, maple.leaf))
    assert 0.27 < triangles(made.lod1) / whole < 0.33
    assert 0.07 < triangles(made.lod2) / whole < 0.09
    assert len(made.impostor.mesh.triangles) == 96


def test_silhouettes_stay_from_all_around(maple: TreeModel, made: Levels) -> None:
    found = level_ious(maple, made)
    assert list(found) == ["lod1", "lod2", "impostor"]
    assert min(found.values()) > 0.9


def test_levels_wear_the_whole_tree_s_textures(maple: TreeModel, made: Levels) -> None:
    for level in (made.lod1, made.lod2):
        assert level.leaf is not None
        assert maple.leaf is not None
        assert level.bark.texture is maple.bark.texture
        assert level.bark.normal_map is maple.bark.normal_map
        assert level.leaf.texture is maple.leaf.texture


def test_every_vertex_holds_to_the_grown_skeleton(maple: TreeModel, made: Levels) -> None:
    points = maple.grown.skeleton.points
    height = np.ptp(points[:, 1])
    for surface in (*made.lod1.surfaces, *made.lod2.surfaces):
        attachment = surface.mesh.attachment
        assert attachment is not None
        start, end = points[attachment.joints.T]
        off = surface.mesh.positions - (start + attachment.share[:, None] * (end - start))
        assert np.linalg.norm(off, axis=1).max() < 0.25 * height


def test_each_view_of_the_impostor_is_the_tree_s(maple: TreeModel, made: Levels) -> None:
    whole = Level(maple.bark, maple.leaf).surfaces
    view = framing(whole, 64)
    for azimuth in AZIMUTHS_RAD[4:]:
        shown = silhouette_from([made.impostor], view, azimuth)
        assert overlap(shown, silhouette_from(whole, view, azimuth)) > 0.9


def test_the_same_tree_gives_the_same_levels(maple: TreeModel, made: Levels) -> None:
    again = levels(maple)
    assert np.array_equal(again.lod2.bark.mesh.positions, made.lod2.bark.mesh.positions)
    assert np.array_equal(again.lod2.surfaces[1].mesh.positions, made.lod2.surfaces[1].mesh.positions)
    assert np.array_equal(again.impostor.texture, made.impostor.texture)


def test_progress_rises_to_the_end(maple: TreeModel) -> None:
    heard: list[tuple[str, float]] = []
    levels(replace(maple, leaf=None, cards=None, atlas=None), lambda *said: heard.append(said))
    assert {stage for stage, _ in heard} == {"levels"}
    assert [share for _, share in heard] == sorted(share for _, share in heard)
    assert heard[-1][1] == 1.0


def test_a_bare_tree_has_levels_of_bark(maple: TreeModel) -> None:
    bare = replace(maple, leaf=None, cards=None, atlas=None)
    made = levels(bare)
    assert made.lod1.leaf is made.lod2.leaf is None
    whole = len(bare.bark.mesh.triangles)
    assert 0.27 < triangles(made.lod1) / whole < 0.33
    assert 0.07 < triangles(made.lod2) / whole < 0.09


def test_a_stick_with_one_card_has_levels_too(maple: TreeModel) -> None:
    assert maple.cards is not None
    assert maple.atlas is not None
    assert maple.leaf is not None
    one = maple.cards.select(np.arange(len(maple.cards)) == 0)
    tree = replace(
        maple,
        grown=replace(maple.grown, skeleton=stick()),
        bark=replace(maple.bark, mesh=tubes(stick())),
        cards=one,
        leaf=replace(maple.leaf, mesh=cards(one, maple.atlas)),
    )
    made = levels(tree)
    assert len(made.lod2.surfaces[1].mesh.triangles) == 2
    assert len(made.lod2.bark.mesh.triangles) <= 100
