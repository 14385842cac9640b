from dataclasses import replace

import numpy as np
import pytest

from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaves import Leaves, no_leaves


@pytest.fixture
def leaves() -> Leaves:
    """Three cards of 2 x 1 m that face +Z, at x = -2, 0 and 2; the last mirrored."""
    centres = np.array([[-2.0, 5, 1], [0, 6, 1], [2, 5, 1]])
    rights, ups = np.tile([1.0, 0, 0], (3, 1)), np.tile([0, 0.5, 0], (3, 1))
    shades, joints = np.array([0.6, 0.8, 1.0]), np.array([1, 2, 3])
    return Leaves(centres, rights, ups, np.array([0, 5, 5]), np.array([False, False, True]), shades, joints)


def test_a_card_is_two_triangles_that_face_the_viewer(leaves, atlas):
    mesh = cards(leaves, atlas)
    assert mesh.triangles.shape == (6, 3)
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    assert np.cross(b - a, c - a)[:, 2] == pytest.approx(1 * 2.0)


def test_corners_stand_half_extents_off_the_centre(leaves, atlas):
    corners = cards(leaves, replace(atlas, fold=0.0)).positions[4:8]
    assert corners.tolist() == [[-1, 5.5, 1], [1, 5.5, 1], [1, 6.5, 1], [-1, 6.5, 1]]


def test_a_card_is_folded_outward_along_its_tile_s_diagonal(leaves, atlas):
    mesh = cards(leaves, replace(atlas, fold=0.4))
    plain, mirrored = mesh.positions[4:8, 2], mesh.positions[8:12, 2]
    assert plain == pytest.approx([1.2, 0.8, 1.2, 0.8])
    assert mirrored == pytest.approx([0.8, 1.2, 0.8, 1.2])
    for triangle in mesh.triangles[2:]:
        assert (mesh.positions[triangle, 2] > 1).sum() == 2


def test_fruit_is_not_folded(leaves, atlas):
    heights = cards(leaves, replace(atlas, fold=0.4, fruit=5)).positions[:, 2]
    assert np.ptp(heights[:4]) > 0.3
    assert np.ptp(heights[4:]) == 0


def test_a_card_holds_to_its_joint(leaves, atlas):
    attachment = cards(leaves, atlas).attachment
    assert attachment.joints.tolist() == np.repeat([[1, 1], [2, 2], [3, 3]], 4, axis=0).tolist()
    assert not attachment.share.any()


def test_normals_are_unit_and_lean_outward(leaves, atlas):
    normals = cards(leaves, atlas).normals
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1, abs=1e-6)
    assert normals[:4, 0].mean() < -0.3
    assert normals[8:, 0].mean() > 0.3


def test_texture_stands_upright_in_its_tile_and_flips(leaves, atlas):
    uvs = cards(leaves, atlas).uvs.astype(float)
    left, top, right, bottom = atlas.boxes[5]
    assert uvs[4:8].tolist() == [[left, bottom], [right, bottom], [right, top], [left, top]]
    assert uvs[8:12].tolist() == [[right, bottom], [left, bottom], [left, top], [right, top]]


def test_shades_reach_all_four_corners(leaves, atlas):
    assert cards(leaves, atlas).shades == pytest.approx(np.repeat([0.6, 0.8, 1.0], 4))


def test_no_leaves_make_an_empty_mesh(atlas):
    mesh = cards(no_leaves(), atlas)
    assert len(mesh.positions) == 0
    assert len(mesh.triangles) == 0
