"""The alpha at which leaves are cut is one constant, in the files and in the documents."""

from pathlib import Path

import pytest

from treestroke.codec.gltf.tree import IMPOSTOR_MATERIAL, LEAF_MATERIAL
from treestroke.core.geometry.mesh import ALPHA_CUT

FORMATS = Path(__file__).parents[2] / "docs" / "formats.md"


@pytest.mark.parametrize("material", [LEAF_MATERIAL, IMPOSTOR_MATERIAL], ids=["leaf", "impostor"])
def test_the_glb_s_materials_are_cut_at_the_constant(material: dict[str, object]) -> None:
    assert material["alphaCutoff"] == ALPHA_CUT


@pytest.mark.parametrize("place", ["`MASK`, cutoff {}", "`opacityThreshold` {} for leaves"])
def test_the_documents_name_the_constant(place: str) -> None:
    assert place.format(ALPHA_CUT) in FORMATS.read_text()
