"""Siblings of a model over HTTP."""

from typing import Any

import httpx
import pytest
from tests.api.conftest import Service


def test_siblings_are_a_new_model_of_the_same_inputs(service: Service, made: dict[str, Any]) -> None:
    wanted = {"count": 2, "envelope": "triangle", "scene": True, "name": "Two more"}
    answer = service.client.post(f"/v1/models/{made['id']}/siblings", json=wanted)
    assert answer.status_code in (200, 202)
    assert answer.headers["location"] == f"/v1/models/{answer.json()['id']}"
    told = service.finished(answer)
    assert (told["status"], told["name"], told["photo"]) == ("succeeded", "Two more", made["photo"])
    assert {"tree.glb", "tree.s1.glb", "tree.s2.glb", "tree.grove.glb"} <= told["files"].keys()
    assert len(told["report"]["siblings"]) == 2
    assert service.client.get(told["files"]["tree.s2.glb"]).content.startswith(b"glTF")


def test_siblings_of_no_model_are_not_found(client: httpx.Client) -> None:
    assert client.post("/v1/models/mdl_" + 24 * "0" + "/siblings", json={"count": 1}).status_code == 404


@pytest.mark.parametrize(
    ("wanted", "pointer"),
    [
        ({"count": 0}, "/count"),
        ({"count": 17}, "/count"),
        ({"envelope": "star"}, "/envelope"),
        ({"envelope": {"points": [[0, 0], [1, 1], [2, 2]]}}, "/envelope"),
        ({"scene": 1}, "/scene"),
    ],
)
def test_what_cannot_be_made_is_refused_where_it_stands(
    client: httpx.Client, made: dict[str, Any], wanted: dict[str, Any], pointer: str
) -> None:
    answer = client.post(f"/v1/models/{made['id']}/siblings", json=wanted)
    assert answer.status_code == 422
    assert pointer in answer.text
