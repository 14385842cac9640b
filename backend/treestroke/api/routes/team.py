"""A team and its members."""

from http import HTTPStatus

from fastapi import APIRouter, Depends

from treestroke.account_schemas import MemberInfo, MemberList, TeamInfo
from treestroke.api.account_views import member_info, team_view
from treestroke.api.deps import JsonBody, MemberId, PrincipalOf, ResourcesOf, body_of, hosted_only
from treestroke.api.errors import BODY, documented
from treestroke.service import members

router = APIRouter(prefix="/v1", tags=["team"], dependencies=[Depends(hosted_only)])


@router.get("/team", responses=documented("not_hosted"))
def get_team(resources: ResourcesOf, principal: PrincipalOf) -> TeamInfo:
    """Look one's team up."""
    return team_view(members.get_team(resources.database, principal))


@router.patch("/team", responses=documented(*BODY, "not_hosted", "storage_full"), openapi_extra=body_of("TeamChange"))
def rename_team(resources: ResourcesOf, principal: PrincipalOf, body: JsonBody) -> TeamInfo:
    """Name the team."""
    return team_view(members.rename_team(resources.database, principal, body))


@router.get("/members", responses=documented("not_hosted"))
def list_members(resources: ResourcesOf) -> MemberList:
    """List the members of the team, the first one first."""
    return MemberList(members=[member_info(row) for row in members.list_members(resources.database)])


@router.post(
    "/members",
    status_code=HTTPStatus.CREATED,
    responses=documented(*BODY, "not_hosted", "storage_full"),
    openapi_extra=body_of("MemberRequest"),
)
def add_member(resources: ResourcesOf, body: JsonBody) -> MemberInfo:
    """Add a member, who signs in by a key that an owner makes for them."""
    return member_info(members.add_member(resources.database, body))


@router.patch(
    "/members/{id}",
    responses=documented(*BODY, "not_hosted", "member_not_found", "last_owner", "storage_full"),
    openapi_extra=body_of("MemberChange"),
)
def change_member(resources: ResourcesOf, principal: PrincipalOf, id: MemberId, body: JsonBody) -> MemberInfo:
    """Give a member another name or role, which holds from their next request on."""
    return member_info(members.change_member(resources.database, principal, id, body))


@router.delete(
    "/members/{id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=documented("not_hosted", "member_not_found", "last_owner", "storage_full"),
)
def remove_member(resources: ResourcesOf, principal: PrincipalOf, id: MemberId) -> None:
    """Remove a member, with their keys and sessions; what they made stays."""
    members.remove_member(resources.database, principal, id)
