"""Pixels become metres, and metres pixels, in cameras alone."""

import ast
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "backend" / "treestroke"
MAY_READ = {
    "core/geometry/camera.py": "is where it stands",
    "codec/skeleton.py": "writes the photo's frame into files, as extras.photo has it",
    "codec/preview.py": "draws its front view at the photo's framing, in a picture of its own size",
    "codec/structure.py": "writes a capture's cameras into files",
    "core/undistortion.py": "takes the distortion of a camera's lens out of its picture",
    "engines/mapping.py": "tells COLMAP, which has cameras of its own",
    "service/report.py": "reports the scale",
    "codec/cameras.py": "writes the cameras of a capture into reports and files",
    "core/pipeline/captured_photos.py": "scales the focal length with the photo",
    "core/geometry/similarity.py": "carries cameras into another frame",
    "core/geometry/plane_maps.py": "maps planes of space from one picture to another",
    "core/segment/view_mattes_solid.py": "projects millions of cells in single precision",
}
SECTIONS = {
    "core/geometry/outline_volume.py": "stores outlines as rows of the picture that they were seen in",
    "core/lift/imagined.py": "imagines the crown's side by its front picture",
    "core/grow/growing.py": "grows in pixels of the front picture",
    "core/grow/compiled.py": "grows in pixels of the front picture",
    "core/grow/growth_space.py": "grows in pixels of the front picture",
    "core/grow/stem.py": "grows in pixels of the front picture",
}


def reading(names: set[str]) -> set[str]:
    """Files that read one of some attributes."""
    found = set()
    for path in SOURCE.rglob("*.py"):
        nodes = ast.walk(ast.parse(path.read_text()))
        if any(isinstance(node, ast.Attribute) and node.attr in names for node in nodes):
            found.add(path.relative_to(SOURCE).as_posix())
    return found


def test_only_cameras_convert_between_pictures_and_the_world() -> None:
    assert reading({"root_px", "metres_per_pixel", "focal_px", "principal_px", "camera_from_world"}) == set(MAY_READ)


def test_only_growth_reads_a_crowns_rows() -> None:
    assert reading({"middle_px", "near_px", "deep_px", "sections"}) - {"core/grow/replacement.py"} == set(SECTIONS)
