"""The files of one tree, as its settings ask for them."""

from collections.abc import Mapping

from treestroke.codec.gltf.tree import Part, encode_glb
from treestroke.core.pipeline.photo import TreeModel
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report

Bundle = Mapping[str, bytes]


def tree_files(tree: TreeModel, settings: ModelSettings, name: str, generator: str, report: Report) -> dict[str, Bundle]:
    report("write", 0.0)
    parts = [Part("bark", tree.bark)] + ([] if tree.leaf is None else [Part("leaf", tree.leaf)])
    glb = encode_glb(parts, tree.camera, generator=generator)
    report("write", 1.0)
    return {f"{name}.glb": {f"{name}.glb": glb}}
