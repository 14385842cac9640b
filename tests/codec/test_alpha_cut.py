"""The alpha at which leaves are cut is one constant, in the files and in the documents."""

from pathlib import Path

import pytest

from treestroke.codec.gltf.tree import MATERIALS, MaterialName
from treestroke.core.geometry.mesh import ALPHA_CUT

FORMATS = Path(__file__).parents[2] / "docs" / "formats.md"


@pytest.mark.parametrize("name", ["leaf", "impostor"])
def test_the_glb_s_materials_are_cut_at_the_constant(name: MaterialName) -> None:
    assert MATERIALS[name].properties["alphaCutoff"] == ALPHA_CUT


@pytest.mark.parametrize("place", ["`MASK`, cutoff {}", "`opacityThreshold` {} for leaves"])
def test_the_documents_name_the_constant(place: str) -> None:
    assert place.format(ALPHA_CUT) in FORMATS.read_text()
