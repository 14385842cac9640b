"""What each file of a tree costs, and how alike its levels of detail are (part of make bench)."""

import sys
import time
from pathlib import Path

import numpy as np
from tests.levels import level_ious

import treestroke
from treestroke.core.pipeline.levels import levels
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import silent
from treestroke.service.files import files_on_offer, tree_files

EXAMPLES = Path(__file__).parents[2] / "examples"
SETTINGS = {
    "plain": ModelSettings(),
    "wind": ModelSettings(wind="all"),
    "compressed": ModelSettings(compress=True),
    "compressed, wind": ModelSettings(compress=True, wind="all"),
    "levels in one": ModelSettings(lod="one"),
}


def rows(name: str) -> list[tuple[str, int, float, str]]:
    """Write a tree in every way: what, bytes, seconds, and the least IoU with the whole tree from 8 sides."""
    model = treestroke.model(EXAMPLES / f"{name}.jpg", EXAMPLES / f"{name}.strokes.json")
    ious = level_ious(model.tree, levels(model.tree))
    found = [_row(what, model, settings) for what, settings in SETTINGS.items()]
    found += [_row(file, model, ModelSettings(files=(file,)), of=file) for file in files_on_offer()]
    coarse = tree_files(model.tree, ModelSettings(lod="files"), "tree", "treestroke", silent)
    for level, iou in ious.items():
        found.append((level, len(coarse[f"tree.{level}.glb"][f"tree.{level}.glb"]), np.nan, f"{iou:.3f}"))
    return found


def _row(what: str, model: treestroke.Model, settings: ModelSettings, of: str = "") -> tuple[str, int, float, str]:
    start = time.perf_counter()
    bundles = list(tree_files(model.tree, settings, "tree", "treestroke", silent).values())
    taken = time.perf_counter() - start
    plain = 0.0
    if of:
        start = time.perf_counter()
        tree_files(model.tree, ModelSettings(), "tree", "treestroke", silent)
        plain = time.perf_counter() - start
    bundle = bundles[1] if of else bundles[0]
    return what, sum(len(content) for content in bundle.values()), taken - plain, ""


if __name__ == "__main__":
    for example in ("sugar_maple_autumn", "burr_oak_dusk"):
        sys.stdout.write(f"{example}: file, bytes, seconds, least IoU of 8 sides\n")
        for what, size, seconds, iou in rows(example):
            sys.stdout.write(f"  {what:<18} {size:>11,} {seconds:>6.2f} {iou}\n")
