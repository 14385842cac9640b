import pytest
from fastapi.routing import APIRoute, iter_route_contexts

from treestroke.account_schemas import KeyScope, Role
from treestroke.api.app import make_app
from treestroke.api.errors import Refusal
from treestroke.api.rules import RULES, Rule, check
from treestroke.service.principals import Principal
from treestroke.settings import Settings

LOOK, CHANGE = Rule("trees", "viewer"), Rule("trees", "member", writes=True)
TEAM, OWN, ANY = Rule("team", "owner", writes=True), Rule("team", "viewer", writes=True), Rule(None, "viewer")
BOTH: tuple[KeyScope, ...] = ("trees", "team")


def refusal(rule: Rule, role: Role, scopes: tuple[KeyScope, ...], read_only: bool = False) -> str:
    try:
        check(rule, Principal("usr_1", "team_1", "Ann", role, frozenset(scopes), read_only))
    except Refusal as error:
        return error.code
    return ""


def test_every_route_has_a_rule_and_every_rule_a_route() -> None:
    found = [route.original_route for route in iter_route_contexts(make_app(Settings()).routes)]
    assert {route.name for route in found if isinstance(route, APIRoute)} == set(RULES)


def test_only_health_page_signing_in_and_links_are_open() -> None:
    shared = {"get_shared_page", "get_shared_model", "get_shared_tree", "get_shared_preview", "get_shared_photo"}
    one_person = {"metrics"}  # a route that a service with keys has not
    open_to_all = {"live", "ready", "page", "icon", "sign_in", "get_oembed", *shared, *one_person}
    signing_in = {"ways_to_sign_in", "begin_oidc", "finish_oidc"}
    assert {name for name, rule in RULES.items() if rule is None} == open_to_all | signing_in


def test_whatever_is_sent_to_change_something_is_a_write() -> None:
    harmless = {"trace_photo", "trace_sketches", "trace_capture", "trace_clip", "sign_in", "sign_out"}
    found = [route.original_route for route in iter_route_contexts(make_app(Settings()).routes)]
    for route in (route for route in found if isinstance(route, APIRoute)):
        rule = RULES[route.name]
        if route.methods & {"POST", "PUT", "PATCH", "DELETE"}:
            assert route.name in harmless or (rule is not None and rule.writes), route.name


@pytest.mark.parametrize(
    ("rule", "viewer", "member", "owner"),
    [
        (LOOK, "", "", ""),
        (ANY, "", "", ""),
        (OWN, "", "", ""),
        (CHANGE, "role_missing", "", ""),
        (TEAM, "role_missing", "role_missing", ""),
    ],
)
def test_roles(rule: Rule, viewer: str, member: str, owner: str) -> None:
    assert [refusal(rule, role, BOTH) for role in ("viewer", "member", "owner")] == [viewer, member, owner]


@pytest.mark.parametrize(
    ("rule", "trees", "team", "reading"),
    [
        (LOOK, "", "scope_missing", ""),
        (ANY, "", "", ""),
        (CHANGE, "", "scope_missing", "read_only"),
        (OWN, "scope_missing", "", "read_only"),
        (TEAM, "scope_missing", "", "read_only"),
    ],
)
def test_scopes_and_keys_that_only_read(rule: Rule, trees: str, team: str, reading: str) -> None:
    assert refusal(rule, "owner", ("trees",)) == trees
    assert refusal(rule, "owner", ("team",)) == team
    assert refusal(rule, "owner", BOTH, read_only=True) == reading
