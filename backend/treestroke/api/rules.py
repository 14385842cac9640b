"""Who may do what: one rule for each route, by the route's name. A route without a rule is open to nobody."""

from dataclasses import dataclass

from treestroke.account_schemas import KeyScope, Role
from treestroke.api.errors import Refusal
from treestroke.service.principals import ROLES, Principal


@dataclass(frozen=True)
class Rule:
    """What it takes to use a route: a scope (None: any), a role or a higher one, and to write a key that may."""

    scope: KeyScope | None
    role: Role
    writes: bool = False


_LOOK = Rule("trees", "viewer")
_CHANGE = Rule("trees", "member", writes=True)
_SIGNED_IN = Rule(None, "viewer")
_LOOK_AT_TEAM = Rule("team", "viewer")
_CHANGE_OWN_KEYS = Rule("team", "viewer", writes=True)
_LOOK_AT_WEBHOOKS = Rule("team", "owner")
_CHANGE_TEAM = Rule("team", "owner", writes=True)

RULES: dict[str, Rule | None] = {
    **dict.fromkeys(("live", "ready", "page", "icon", "sign_in"), None),
    "metrics": None,  # a route of a service with one person alone
    **dict.fromkeys(("ways_to_sign_in", "begin_oidc", "finish_oidc"), None),
    **dict.fromkeys(("get_shared_page", "get_shared_model", "get_shared_tree"), None),
    **dict.fromkeys(("get_shared_preview", "get_shared_photo", "get_oembed"), None),
    **dict.fromkeys(("limits", "version", "get_session", "sign_out"), _SIGNED_IN),
    **dict.fromkeys(("list_photos", "get_photo", "get_image", "trace_photo", "trace_sketches"), _LOOK),
    **dict.fromkeys(("add_photo", "delete_photo"), _CHANGE),
    **dict.fromkeys(("list_captures", "get_capture", "get_capture_photo", "get_capture_image"), _LOOK),
    **dict.fromkeys(("trace_capture", "follow_capture"), _LOOK),
    **dict.fromkeys(("make_capture", "rename_capture", "delete_capture", "restore_capture"), _CHANGE),
    **dict.fromkeys(("add_capture_photo", "remove_capture_photo", "solve_capture", "cancel_solve"), _CHANGE),
    **dict.fromkeys(("list_clips", "get_clip", "get_clip_video", "get_clip_frame", "trace_clip"), _LOOK),
    **dict.fromkeys(("add_clip", "delete_clip", "get_upload", "add_piece", "delete_upload"), _CHANGE),
    **dict.fromkeys(("list_models", "get_model", "follow_model", "get_tree", "get_preview", "get_tree_file"), _LOOK),
    **dict.fromkeys(("get_strokes", "get_views", "get_frame_strokes", "get_edits", "get_sketch", "get_project"), _LOOK),
    **dict.fromkeys(("ask_for_model", "ask_for_siblings", "change_model", "cancel_model"), _CHANGE),
    **dict.fromkeys(("delete_model", "restore_model", "share_model", "revoke_share"), _CHANGE),
    "list_shares": _LOOK,
    **dict.fromkeys(("get_team", "list_members", "list_keys"), _LOOK_AT_TEAM),
    "list_audit": Rule("team", "owner"),
    **dict.fromkeys(("make_key", "revoke_key"), _CHANGE_OWN_KEYS),
    **dict.fromkeys(("list_webhooks", "list_deliveries"), _LOOK_AT_WEBHOOKS),
    **dict.fromkeys(("make_webhook", "change_webhook", "remove_webhook"), _CHANGE_TEAM),
    **dict.fromkeys(("ping_webhook", "resend_delivery"), _CHANGE_TEAM),
    **dict.fromkeys(("rename_team", "add_member", "change_member", "remove_member"), _CHANGE_TEAM),
}
"""The rule of each route by its name; None: open to all, without a key."""


def check(rule: Rule, who: Principal) -> None:
    """Check that somebody may do what a rule is about.

    Raises
    ------
    Refusal
        Their key has not the scope or is read-only, or their role is too low.
    """
    if rule.scope is not None and rule.scope not in who.scopes:
        raise Refusal("scope_missing", f"your key has not the scope {rule.scope}; use one that has it")
    if ROLES.index(who.role) < ROLES.index(rule.role):
        raise Refusal("role_missing", f"this takes the role {rule.role}, and yours is {who.role}; ask an owner for it")
    if rule.writes and who.read_only:
        raise Refusal("read_only", "your key only reads; use one that is not read-only")
