import json
from dataclasses import replace

import numpy as np
import pygltflib
import pytest
from tests.builders import oak

from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.tubes import tubes
from treestroke.core.sway.motion import Motion
from treestroke.core.sway.skinning import skin
from treestroke.core.sway.wind import wind_of

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))


@pytest.fixture(scope="module")
def wind() -> Motion:
    tree = oak()
    return wind_of(tree, ("breeze", "gust"), np.arange(60, len(tree)))


@pytest.fixture(scope="module")
def part(wind: Motion) -> Part:
    mesh = tubes(oak())
    return Part("bark", Surface(mesh, np.full((8, 4, 3), 90, np.uint8)), skin(wind.rig, mesh, leaves=False))


@pytest.fixture(scope="module")
def gltf(wind: Motion, part: Part) -> pygltflib.GLTF2:
    return pygltflib.GLTF2.load_from_bytes(
        encode_glb([part], CAMERA, provenance=Provenance("treestroke 1"), motion=wind)
    )


def values(gltf: pygltflib.GLTF2, index: int) -> np.ndarray:
    row = gltf.accessors[index]
    kind = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}[row.componentType]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[row.type]
    start = gltf.bufferViews[row.bufferView].byteOffset
    return np.frombuffer(gltf.binary_blob(), kind, row.count * width, start).reshape(row.count, width)


def test_the_scene_holds_the_mesh_and_the_root_bone_beside_it(gltf: pygltflib.GLTF2) -> None:
    names = [gltf.nodes[index].name for index in gltf.scenes[0].nodes]
    assert names == ["bark", "root"]
    assert gltf.nodes[0].skin == 0
    assert gltf.skins[0].name == "wind"
    assert gltf.skins[0].skeleton == gltf.scenes[0].nodes[1]


def test_joints_stand_where_bones_start_and_inverse_binds_undo_them(gltf: pygltflib.GLTF2, wind: Motion) -> None:
    joints = gltf.skins[0].joints
    place = {gltf.skins[0].skeleton: np.array(gltf.nodes[gltf.skins[0].skeleton].translation)}
    for index in joints:
        assert gltf.nodes[index].rotation is None
        for child in gltf.nodes[index].children or []:
            place[child] = place[index] + gltf.nodes[child].translation
    heads = np.array([place[index] for index in joints])
    assert [gltf.nodes[index].name for index in joints] == list(wind.rig.names)
    assert heads == pytest.approx(wind.rig.heads, abs=1e-5)
    matrices = values(gltf, gltf.skins[0].inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    assert matrices[:, :3, 3] == pytest.approx(-heads, abs=1e-6)
    assert np.array_equal(matrices[:, :, :3], np.tile(np.eye(4)[:, :3], (len(joints), 1, 1)))


def test_branch_bones_have_their_radius(gltf: pygltflib.GLTF2, wind: Motion) -> None:
    told = [(gltf.nodes[index].extras or {}).get("radius", 0.0) for index in gltf.skins[0].joints]
    assert told == pytest.approx(wind.rig.radii, abs=1e-6)


def test_vertices_name_bones_by_byte_and_carry_sway_and_phase(gltf: pygltflib.GLTF2, part: Part) -> None:
    attributes = gltf.meshes[0].primitives[0].attributes
    assert np.array_equal(values(gltf, attributes.JOINTS_0), part.skin.bones)
    assert np.array_equal(values(gltf, attributes.WEIGHTS_0), part.skin.weights)
    assert np.array_equal(values(gltf, attributes._SWAY)[:, 0], part.skin.sway)
    assert np.array_equal(values(gltf, attributes._PHASE)[:, 0], part.skin.phase)
    assert not gltf.accessors[attributes.JOINTS_0].normalized
    assert gltf.accessors[attributes.WEIGHTS_0].normalized


def test_animations_turn_joints(gltf: pygltflib.GLTF2, wind: Motion) -> None:
    assert [animation.name for animation in gltf.animations] == ["breeze", "gust"]
    for written, animation in zip(gltf.animations, wind.animations, strict=True):
        targets = [gltf.nodes[channel.target.node].name for channel in written.channels]
        assert targets == [wind.rig.names[bone] for bone in animation.bones]
        assert {channel.target.path for channel in written.channels} == {"rotation"}
        for channel, times, turns in zip(written.channels, animation.times, animation.rotations, strict=True):
            sampler = written.samplers[channel.sampler]
            assert np.array_equal(values(gltf, sampler.input)[:, 0], times.astype(np.float32))
            assert np.array_equal(values(gltf, sampler.output), turns.astype(np.float32))


def test_times_are_bounded_and_shared(gltf: pygltflib.GLTF2) -> None:
    for animation in gltf.animations:
        inputs = {sampler.input for sampler in animation.samplers}
        assert len(inputs) < len(animation.samplers)
        assert len({gltf.accessors[index].count for index in inputs}) == len(inputs)
        for index in inputs:
            seconds = values(gltf, index)
            assert gltf.accessors[index].min == [0.0]
            assert gltf.accessors[index].max == pytest.approx([float(seconds.max())])


def test_without_wind_the_file_is_that_of_a_mesh_without_attachment(part: Part) -> None:
    still = encode_glb([part], CAMERA, provenance=Provenance("treestroke 1"))
    bare = replace(part, surface=replace(part.surface, mesh=replace(part.surface.mesh, attachment=None)), skin=None)
    assert still == encode_glb([bare], CAMERA, provenance=Provenance("treestroke 1"))
    assert "skins" not in json.loads(still[20 : 20 + int.from_bytes(still[12:16], "little")])


def test_equal_wind_gives_equal_bytes(wind: Motion, part: Part) -> None:
    first, second = (encode_glb([part], CAMERA, provenance=Provenance("treestroke 1"), motion=wind) for _ in range(2))
    assert first == second


def test_rotations_of_many_keyframes_are_kept_in_16_bit(wind: Motion, part: Part) -> None:
    many = replace(wind, animations=(replace(wind.animations[0], many=True),))
    content = encode_glb([part], CAMERA, provenance=Provenance("treestroke 1"), motion=many)
    gltf = pygltflib.GLTF2.load_from_bytes(content)
    for sampler, turns in zip(gltf.animations[0].samplers, many.animations[0].rotations, strict=True):
        row = gltf.accessors[sampler.output]
        assert (row.componentType, row.normalized) == (5122, True)
        start = gltf.bufferViews[row.bufferView].byteOffset
        kept = np.frombuffer(gltf.binary_blob(), np.int16, row.count * 4, start).reshape(row.count, 4) / 32767
        assert kept == pytest.approx(turns, abs=2e-5)
