import numpy as np
import pygltflib
import pytest
from tests.codec.gltf.test_tree import CAMERA, bark, leaves

from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.geometry.mesh import Surface

FLAT = np.full((4, 4, 3), 128, np.uint8)


def coarser(material: str, surface: Surface, names: tuple[str, ...] = ("_lod1", "_lod2")) -> tuple[Part, ...]:
    return tuple(Part(material, Surface(surface.mesh, surface.texture), suffix=name) for name in names)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def gltf() -> pygltflib.GLTF2:
    wood, foliage, far = bark(), leaves(), leaves(1)
    impostor = Part("impostor", Surface(far.mesh, far.texture, FLAT))
    parts = [
        Part("bark", wood, coarser=coarser("bark", wood)),
        Part("leaf", foliage, coarser=(*coarser("leaf", foliage), impostor)),
    ]
    return pygltflib.GLTF2.load_from_bytes(encode_glb(parts, CAMERA, provenance=Provenance("treestroke 1")))


def names(gltf: pygltflib.GLTF2, ids: list[int]) -> list[str]:
    return [gltf.nodes[index].name for index in ids]


def test_a_reader_without_the_extension_shows_the_finest_alone(gltf: pygltflib.GLTF2) -> None:
    assert names(gltf, gltf.scenes[0].nodes) == ["bark", "leaf"]
    assert "MSFT_lod" in gltf.extensionsUsed
    assert not gltf.extensionsRequired
    assert all(not node.children for node in gltf.nodes)


def test_each_node_names_its_own_levels(gltf: pygltflib.GLTF2) -> None:
    wood, foliage = (gltf.nodes[index] for index in gltf.scenes[0].nodes)
    assert names(gltf, wood.extensions["MSFT_lod"]["ids"]) == ["bark_lod1", "bark_lod2"]
    assert names(gltf, foliage.extensions["MSFT_lod"]["ids"]) == ["leaf_lod1", "leaf_lod2", "impostor"]


def test_wood_is_hidden_where_the_impostor_is_shown(gltf: pygltflib.GLTF2) -> None:
    wood, foliage = (gltf.nodes[index].extras["MSFT_screencoverage"] for index in gltf.scenes[0].nodes)
    assert foliage == [*wood, 0.0]
    assert wood == sorted(wood, reverse=True)
    assert wood[-1] > 0


def test_levels_share_materials_and_textures(gltf: pygltflib.GLTF2) -> None:
    assert [material.name for material in gltf.materials] == ["bark", "leaf", "leaf_impostor"]
    assert len(gltf.images) == 4
    material_of = {node.name: gltf.meshes[node.mesh].primitives[0].material for node in gltf.nodes}
    assert material_of["bark"] == material_of["bark_lod1"] == material_of["bark_lod2"] == 0
    assert material_of["leaf"] == material_of["leaf_lod1"] == material_of["leaf_lod2"] == 1


def test_an_impostor_is_cut_and_seen_from_its_front_alone(gltf: pygltflib.GLTF2) -> None:
    far = gltf.materials[2]
    assert (far.alphaMode, far.alphaCutoff, bool(far.doubleSided)) == ("MASK", 0.3, False)
    assert far.normalTexture.index == 3


def test_a_bare_tree_s_bark_ends_in_the_impostor() -> None:
    wood, far = bark(), leaves(1)
    levels = (*coarser("bark", wood), Part("impostor", Surface(far.mesh, far.texture, FLAT)))
    file = encode_glb([Part("bark", wood, coarser=levels)], CAMERA, provenance=Provenance("treestroke 1"))
    gltf = pygltflib.GLTF2.load_from_bytes(file)
    assert names(gltf, gltf.nodes[0].extensions["MSFT_lod"]["ids"]) == ["bark_lod1", "bark_lod2", "impostor"]
    assert gltf.nodes[0].extras["MSFT_screencoverage"][-1] == 0.0


def test_no_level_means_no_extension() -> None:
    gltf = pygltflib.GLTF2.load_from_bytes(
        encode_glb([Part("bark", bark())], CAMERA, provenance=Provenance("treestroke 1"))
    )
    assert "MSFT_lod" not in (gltf.extensionsUsed or [])


def test_more_levels_than_sizes_are_refused() -> None:
    wood = bark()
    many = coarser("bark", wood, ("_a", "_b", "_c", "_d"))
    with pytest.raises(ValueError, match="at most 3"):
        encode_glb([Part("bark", wood, coarser=many)], CAMERA, provenance=Provenance("treestroke 1"))


def test_a_collision_mesh_has_its_name() -> None:
    file = encode_glb([Part("collision", bark())], CAMERA, provenance=Provenance("treestroke 1"))
    gltf = pygltflib.GLTF2.load_from_bytes(file)
    assert (gltf.nodes[0].name, gltf.materials[0].name) == ("collision", "collision")
