import csv
import io
import json

import numpy as np
from tests.builders import fork, oak

from treestroke.codec.skeleton_files import encode_csv, encode_skeleton_json, encode_swc
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.skeleton.skeleton import Skeleton

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))


def test_json_holds_the_skeleton_to_a_hundredth_of_a_millimetre() -> None:
    tree = oak()
    read = json.loads(encode_skeleton_json(tree, np.arange(len(tree)), CAMERA))
    assert (read["schema"], read["version"], read["unit"]) == ("treestroke.skeleton", 1, "metre")
    again = Skeleton(np.array(read["points"]), np.array(read["radii"]), np.array(read["parents"]))
    assert np.allclose(again.points, tree.points, atol=5.1e-6)
    assert np.array_equal(again.parents, tree.parents)
    assert read["born"] == list(range(len(tree)))
    assert read["photo"]["metres_per_pixel"] == 0.01


def test_orders_rise_where_the_thinner_limb_leaves() -> None:
    read = json.loads(encode_skeleton_json(fork(), None, CAMERA))
    assert read["orders"] == [0, 0, 0, 0, 0, 1, 1]
    assert "born" not in read


def test_swc_has_its_seven_columns_with_parents_first() -> None:
    lines = encode_swc(fork()).decode().splitlines()
    head, rows = lines[:4], np.array([line.split() for line in lines[4:]], dtype=float)
    assert all(line.startswith("#") for line in head)
    assert "metre" in head[2]
    assert rows[:, 0].tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert rows[:, 1].tolist() == [1, 3, 3, 3, 3, 3, 3]
    assert np.allclose(rows[:, 2:5], fork().points, atol=5.1e-6)
    assert np.allclose(rows[:, 5], fork().radii, atol=5.1e-6)
    assert rows[:, 6].tolist() == [-1, 1, 2, 3, 4, 3, 6]


def test_csv_has_a_row_a_joint() -> None:
    rows = list(csv.DictReader(io.StringIO(encode_csv(fork(), np.arange(7) * 2).decode())))
    assert [int(row["parent"]) for row in rows] == fork().parents.tolist()
    assert [int(row["born"]) for row in rows] == [0, 2, 4, 6, 8, 10, 12]
    assert [int(row["order"]) for row in rows] == [0, 0, 0, 0, 0, 1, 1]
    assert np.isclose(float(rows[4]["path_m"]), 3.6)
    assert np.isclose(float(rows[2]["y_m"]), 2.0)


def test_csv_leaves_unknown_births_empty() -> None:
    rows = list(csv.DictReader(io.StringIO(encode_csv(fork(), None).decode())))
    assert {row["born"] for row in rows} == {""}
    assert float(rows[-1]["path_m"]) > 0
