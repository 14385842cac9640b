"""Teams, members and keys as the API shows them."""

from collections.abc import Collection, Mapping

from treestroke.account_schemas import AuditEntry, KeyInfo, KeyScope, Member, MemberInfo, NewKey, TeamInfo
from treestroke.schemas import MakerInfo
from treestroke.service.keys import MadeKey
from treestroke.service.principals import SCOPES, Principal
from treestroke.store.account_tables import KeyRow, MemberRow, TeamRow
from treestroke.store.tables import AuditRow


def team_view(row: TeamRow) -> TeamInfo:
    """Return a team as the API shows it."""
    return TeamInfo(id=row.team, name=row.name, created=row.created)


def member_view(who: MemberRow | Principal) -> Member:
    """Return a member as answers name them."""
    return Member.model_validate({"id": who.id, "name": who.name, "role": who.role})


def member_info(row: MemberRow) -> MemberInfo:
    """Return a member as the list of members shows them."""
    return MemberInfo(**member_view(row).model_dump(), created=row.created)


def key_view(row: KeyRow, member: MemberRow) -> KeyInfo:
    """Return a key as the API shows it."""
    return KeyInfo(
        id=row.id,
        name=row.name,
        beginning=row.beginning,
        member=member_view(member),
        scopes=scope_names(row.scopes.split()),
        read_only=row.read_only,
        created=row.created,
        expires=row.expires,
        last_used=row.last_used,
        revoked=row.revoked,
    )


def new_key_view(made: MadeKey) -> NewKey:
    """Return a key that was just made, with itself."""
    return NewKey(**key_view(made.row, made.member).model_dump(), key=made.key)


def scope_names(scopes: Collection[str]) -> list[KeyScope]:
    """Return scopes in the order in which all answers have them."""
    return [scope for scope in SCOPES if scope in scopes]


def audit_view(row: AuditRow, names: Mapping[str, str]) -> AuditEntry:
    """Return an entry of the audit, with the name of who did it."""
    return AuditEntry(
        id=str(row.number),
        at=row.at,
        who=None if row.who is None else MakerInfo(id=row.who, name=names.get(row.who, "")),
        credential=row.credential,
        action=row.action,
        subject=row.subject,
        details=row.details,
        address=row.address,
        request_id=row.request_id,
    )
