import importlib.util
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS
from tests.clips import clip_bytes
from tests.faults.processes import wait_for

from treestroke import __version__
from treestroke.core.pipeline.settings import FILES, Choice, ModelSettings, Several, Span
from treestroke.service.engine_version import engine_version

METHODS = {"get", "put", "post", "delete", "patch"}
OPERATIONS = {
    "add_member",
    "change_member",
    "change_model",
    "get_oembed",
    "get_session",
    "ways_to_sign_in",
    "begin_oidc",
    "finish_oidc",
    "get_shared_model",
    "get_shared_page",
    "get_shared_photo",
    "get_shared_preview",
    "get_shared_tree",
    "get_team",
    "list_audit",
    "list_keys",
    "list_members",
    "list_shares",
    "list_webhooks",
    "make_webhook",
    "change_webhook",
    "remove_webhook",
    "ping_webhook",
    "list_deliveries",
    "resend_delivery",
    "make_key",
    "remove_member",
    "rename_team",
    "revoke_key",
    "revoke_share",
    "share_model",
    "sign_in",
    "sign_out",
    "add_photo",
    "list_photos",
    "get_photo",
    "delete_photo",
    "get_image",
    "trace_photo",
    "trace_sketches",
    "make_capture",
    "list_captures",
    "get_capture",
    "delete_capture",
    "add_capture_photo",
    "get_capture_photo",
    "get_capture_image",
    "remove_capture_photo",
    "solve_capture",
    "cancel_solve",
    "follow_capture",
    "trace_capture",
    "rename_capture",
    "restore_capture",
    "add_clip",
    "list_clips",
    "get_clip",
    "delete_clip",
    "get_clip_video",
    "get_clip_frame",
    "trace_clip",
    "get_upload",
    "add_piece",
    "delete_upload",
    "ask_for_model",
    "ask_for_siblings",
    "list_models",
    "get_model",
    "delete_model",
    "restore_model",
    "cancel_model",
    "follow_model",
    "get_tree",
    "get_preview",
    "get_strokes",
    "get_views",
    "get_frame_strokes",
    "get_edits",
    "get_sketch",
    "get_project",
    "get_tree_file",
    "live",
    "ready",
    "limits",
    "version",
}


@pytest.fixture(scope="module")
def document(client: httpx.Client) -> dict[str, Any]:
    return dict(client.get("/openapi.json").json())


def operations(document: dict[str, Any]) -> dict[str, Any]:
    return {f"{method} {path}": one for path, all_ in document["paths"].items() for method, one in all_.items()}


def test_the_service_lives_and_is_ready(client: httpx.Client) -> None:
    assert client.get("/livez").json() == {"status": "ok", "checks": {}}
    # The worker says that it lives a moment after the web process does.
    wait_for(lambda: client.get("/readyz").json()["status"] == "ok", PATIENCE_SECONDS, "a service that is ready", 0.2)
    assert client.get("/readyz").status_code == 200


def test_the_limits_are_told(client: httpx.Client) -> None:
    limits = client.get("/v1/limits").json()
    assert (limits["photo_bytes"], limits["photo_pixels"]) == (25_000_000, 50_000_000)
    assert (limits["photo_stored_bytes"], limits["photos_stored_bytes"]) == (120_000_000, 20_000_000_000)
    assert (limits["photo_side_min"], limits["photo_side_max"]) == (64, 16_384)
    assert (limits["capture_photos_min"], limits["capture_photos_max"]) == (5, 60)
    assert (limits["strokes"], limits["points"]) == (200, 10_000)
    assert (limits["leaf_bytes"], limits["sketch_bytes"]) == (4_000_000, 25_000_000)
    assert set(limits["settings"]) == set(ModelSettings.__dataclass_fields__)
    assert limits["settings"]["height"]["default"] == 10
    assert limits["settings"]["compress"] == {**limits["settings"]["compress"], "toggle": True, "default": False}
    assert {"obj", "swc"} <= set(limits["settings"]["files"]["names"]) <= set(FILES)
    assert ("usdz" in limits["settings"]["files"]["names"]) == (importlib.util.find_spec("pxr") is not None)
    assert (limits["settings"]["height"]["min"], limits["settings"]["height"]["max"]) == (0.1, 150)


def test_a_service_without_teams_has_neither_rates_nor_quotas(client: httpx.Client) -> None:
    answer = client.get("/v1/limits")
    assert (answer.json()["rates"], answer.json()["quotas"]) == ([], [])
    assert "ratelimit" not in answer.headers


def test_the_version_is_told(client: httpx.Client) -> None:
    assert client.get("/v1/version").json() == {
        "version": __version__,
        "engine": engine_version(),
        "api": "v1",
    }


def test_the_figures_of_the_queue_and_the_requests_are_told(client: httpx.Client, made: dict[str, Any]) -> None:
    told = client.get("/metrics").text
    ages = ("queue_age_seconds", "models_queue_age_seconds", "solves_queue_age_seconds")
    for name in ("models_queued", "models_running", "solves_queued", "worker_slots", "tracers_replaced_total", *ages):
        assert re.search(rf"^treestroke_{name}\b", told, re.M), name
    assert 'handler="/v1/models"' in told
    assert made["id"] not in told


def test_every_answer_has_the_safe_headers(client: httpx.Client) -> None:
    for path in ("/", "/favicon.ico", "/livez", "/nothing", "/v1/models", "/openapi.json"):
        headers = client.get(path).headers
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert headers["cache-control"] in ("no-cache", "no-store", "private, no-cache")


def test_what_there_is_not_says_where_to_look(client: httpx.Client) -> None:
    answer = client.get("/v1/tree")
    assert (answer.status_code, answer.headers["content-type"]) == (404, "application/problem+json")
    assert "/openapi.json" in answer.json()["detail"]
    assert client.get("/v1/models/").status_code == 404


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/v1/models", "GET, HEAD, OPTIONS, POST"),
        ("/v1/models/x", "DELETE, GET, HEAD, OPTIONS, PATCH"),
        ("/v1/models/x/cancel", "OPTIONS, POST"),
        ("/v1/captures/x/photos", "OPTIONS, POST"),
        ("/v1/captures/x/photos/y", "DELETE, GET, HEAD, OPTIONS"),
        ("/v1/photos", "GET, HEAD, OPTIONS, POST"),
        ("/v1/photos/x", "DELETE, GET, HEAD, OPTIONS"),
        ("/livez", "GET, HEAD, OPTIONS"),
        ("/metrics", "GET, HEAD, OPTIONS"),
        ("/openapi.json", "GET, HEAD, OPTIONS"),
        ("/", "GET, HEAD, OPTIONS"),
        ("/favicon.ico", "GET, HEAD, OPTIONS"),
        ("/page/assets/x.js", "GET, HEAD, OPTIONS"),
    ],
)
def test_another_method_is_told_which_ones_there_are(client: httpx.Client, path: str, methods: str) -> None:
    for method in ("PUT", "TRACE", "QUERY", "FOO"):
        answer = client.request(method, path)
        assert (answer.status_code, answer.headers["allow"]) == (405, methods)
        assert methods in answer.json()["detail"]
    answer = client.options(path)
    assert (answer.status_code, answer.headers["allow"], answer.content) == (204, methods, b"")


def test_there_is_nothing_to_ask_where_there_is_nothing(client: httpx.Client) -> None:
    assert client.options("/nothing").status_code == client.head("/nothing").status_code == 404


def test_an_invented_method_is_refused_and_makes_no_series(client: httpx.Client) -> None:
    series = client.get("/metrics").text.count("\nhttp_")
    for number in range(20):
        assert client.request(f"FOO{number}", "/v1/models").headers["allow"] == "GET, HEAD, OPTIONS, POST"
        assert client.request(f"FOO{number}", f"/v1/{number}").status_code == 404
        client.get(f"/nothing/{number}")
    told = client.get("/metrics").text
    assert "FOO" not in told
    assert told.count("\nhttp_") - series < 20


def test_head_is_get_without_the_body(
    client: httpx.Client, document: dict[str, Any], made: dict[str, Any], photo: str, tmp_path: Path
) -> None:
    octets = {"Content-Type": "application/octet-stream"}
    clip = client.post("/v1/clips", content=clip_bytes(tmp_path), headers=octets).json()["id"]
    upload = client.post("/v1/clips", headers={"Upload-Complete": "?0", **octets}).json()["id"]
    capture = client.post("/v1/captures").json()["id"]
    of_capture = client.post(f"/v1/captures/{capture}/photos", content=drawn.encoded()).json()["id"]
    ids = {"/v1/captures": capture, "/v1/photos": photo, "/v1/clips": clip, "/v1/uploads": upload}
    named = {"view": "front", "ending": "glb", "photo": of_capture, "frame": 3, "token": "none"}
    paths = [path for path, one in document["paths"].items() if "get" in one and not path.endswith("/events")]
    for template in [*paths, "/", "/favicon.ico", "/nothing", "/page/nothing"]:
        id = next((id for begins, id in ids.items() if template.startswith(begins)), made["id"])
        path = template.format(id=id, **named)
        with client.stream("GET", path) as whole:  # the answer may be gigabytes
            head = client.head(path, headers={"Range": "bytes=0-1"})
            assert head.status_code == whole.status_code, path
            own = {"date": "", "last-modified": "", "x-request-id": ""}
            assert {**head.headers, **own} == {**whole.headers, **own}, path
            assert head.content == b""


def test_the_document_s_settings_are_the_table(document: dict[str, Any]) -> None:
    told = document["components"]["schemas"]["ModelSettings"]["properties"]
    assert list(told) == [entry.name for entry in fields(ModelSettings)]
    for entry in fields(ModelSettings):
        one, allowed = told[entry.name], entry.metadata["allowed"]
        assert one.get("default", []) == (list(entry.default) if isinstance(entry.default, tuple) else entry.default)
        match allowed:
            case Span():
                assert (one["minimum"], one["maximum"]) == (allowed.low, allowed.high)
            case Choice():
                assert one["enum"] == list(allowed.names)
            case Several():
                assert one["items"]["enum"] == list(allowed.names)
            case _:
                assert one["type"] == "boolean"


def test_every_operation_has_a_stable_name_and_a_sentence(document: dict[str, Any]) -> None:
    assert {one["operationId"] for one in operations(document).values()} == OPERATIONS
    assert all(one["description"].rstrip().endswith(".") for one in operations(document).values())


def test_every_problem_is_documented_as_one(document: dict[str, Any]) -> None:
    wanted = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}
    for name, one in operations(document).items():
        problems = {status: told for status, told in one["responses"].items() if status >= "4"}
        assert "403" in problems, name
        if name == "get /readyz":
            del problems["503"]  # the same health as with 200
        if name == "get /s/{token}":
            problems = {status: told for status, told in problems.items() if status not in ("404", "410")}  # pages
        assert all(told["content"] == wanted for told in problems.values()), name
    assert "HTTPValidationError" not in str(document)


def test_every_body_has_an_example(document: dict[str, Any]) -> None:
    asking = {name: one["requestBody"]["content"] for name, one in operations(document).items() if "requestBody" in one}
    assert set(asking) == {
        "post /v1/photos",
        "post /v1/models/{id}/siblings",
        "post /v1/photos/{id}/trace",
        "post /v1/sketches/trace",
        "post /v1/captures",
        "post /v1/captures/{id}/photos",
        "post /v1/captures/{id}/trace",
        "patch /v1/captures/{id}",
        "post /v1/clips",
        "post /v1/clips/{id}/trace",
        "patch /v1/uploads/{id}",
        "post /v1/models",
        "patch /v1/models/{id}",
        "post /v1/models/{id}/shares",
        "post /v1/session",
        "post /v1/keys",
        "post /v1/members",
        "patch /v1/members/{id}",
        "patch /v1/team",
        "post /v1/webhooks",
        "patch /v1/webhooks/{id}",
    }
    for bytes_ in ("post /v1/photos", "post /v1/captures/{id}/photos", "post /v1/clips", "patch /v1/uploads/{id}"):
        del asking[bytes_]
    for name, content in asking.items():
        for kind in content.values():
            schema = document["components"]["schemas"].get(str(kind["schema"].get("$ref")).rpartition("/")[2], {})
            assert "example" in {**schema, **kind}, name


def test_every_reference_in_the_document_leads_somewhere(document: dict[str, Any]) -> None:
    named = set(re.findall(r"#/components/schemas/(\w+)", str(document)))
    assert named <= set(document["components"]["schemas"])
