import json
from typing import Any

import numpy as np
import pytest
from tests.structures import small_structure

from treestroke.codec.structure import StructureError, decode_structure, encode_structure, plain_cloud


def changed(change: Any) -> bytes:
    """Give a structure's text after a change of its plain values."""
    value = json.loads(encode_structure(small_structure()))
    change(value)
    return json.dumps(value).encode()


def test_what_is_read_back_has_the_same_bits() -> None:
    whole = small_structure(points=13)
    again = decode_structure(encode_structure(whole))
    assert encode_structure(again) == encode_structure(whole)
    assert [photo.name for photo in again.photos] == [photo.name for photo in whole.photos]
    for one, other in zip(again.photos, whole.photos, strict=True):
        assert np.array_equal(one.camera.camera_from_world, other.camera.camera_from_world)
        assert (one.camera.focal_px, one.camera.principal_px) == (other.camera.focal_px, other.camera.principal_px)
        assert (one.camera.width, one.camera.height, one.radial) == (64, 48, other.radial)
    for name in ("points", "colours", "seen"):
        one, other = getattr(again.cloud, name), getattr(whole.cloud, name)
        assert np.array_equal(one, other)
        assert one.dtype == other.dtype
    assert again.unused == whole.unused


def test_a_structure_without_points_is_read_back() -> None:
    assert len(decode_structure(encode_structure(small_structure(points=0))).cloud) == 0


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (b"", "malformed_json"),
        (b"[]", "wrong_type"),
        (changed(lambda v: v.update(version=2)), "structure_version"),
        (changed(lambda v: v.pop("cloud")), "missing_key"),
        (changed(lambda v: v["photos"][0].pop("radial")), "missing_key"),
        (changed(lambda v: v["photos"][0].update(focal_px=0)), "structure_unreadable"),
        (changed(lambda v: v["photos"][0].update(focal_px="x")), "wrong_type"),
        (changed(lambda v: v["photos"][0]["camera_from_world"][0].__setitem__(0, 9.0)), "structure_unreadable"),
        (changed(lambda v: v["photos"].clear()), "structure_unreadable"),
        (changed(lambda v: v["cloud"].update(count=6)), "structure_unreadable"),
        (changed(lambda v: v["cloud"].update(points="?")), "structure_unreadable"),
        (changed(lambda v: v["cloud"].update(colours=v["cloud"]["colours"][:-4])), "structure_unreadable"),
    ],
)
def test_what_is_no_structure_is_refused_by_what_is_wrong(text: bytes, code: str) -> None:
    with pytest.raises(StructureError) as refused:
        decode_structure(text)
    assert refused.value.code == code


def test_of_many_points_a_few_are_chosen_evenly() -> None:
    cloud = small_structure(points=100).cloud
    few = plain_cloud(cloud, 10)
    assert few["points"] == cloud.points[::11].tolist()
    assert few["colours"] == cloud.colours[::11].tolist()
    assert plain_cloud(cloud, 100)["points"] == cloud.points.tolist()
