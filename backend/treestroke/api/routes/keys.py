"""Keys of members."""

from http import HTTPStatus

from fastapi import APIRouter, Depends

from treestroke.account_schemas import KeyList, NewKey
from treestroke.api.account_views import key_view, new_key_view
from treestroke.api.deps import JsonBody, KeyId, PrincipalOf, ResourcesOf, SettingsOf, body_of, hosted_only
from treestroke.api.errors import BODY, documented
from treestroke.service import keys

router = APIRouter(prefix="/v1/keys", tags=["team"], dependencies=[Depends(hosted_only)])


@router.get("", responses=documented("not_hosted"))
def list_keys(resources: ResourcesOf, principal: PrincipalOf) -> KeyList:
    """List keys, newest first: an owner sees all of the team, others their own."""
    found = keys.list_keys(resources.database, principal)
    return KeyList(keys=[key_view(row, member) for row, member in found])


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses=documented(*BODY, "not_hosted", "member_not_found", "scope_missing", "storage_full"),
    openapi_extra=body_of("KeyRequest"),
)
def make_key(resources: ResourcesOf, principal: PrincipalOf, settings: SettingsOf, body: JsonBody) -> NewKey:
    """Make a key of one's own, or as an owner of any member. The answer alone holds the key itself."""
    wanted = keys.read_key_request(body)
    return new_key_view(keys.make_key(resources.database, settings.secret, principal, wanted))


@router.delete(
    "/{id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=documented("not_hosted", "key_not_found", "storage_full"),
)
def revoke_key(resources: ResourcesOf, principal: PrincipalOf, id: KeyId) -> None:
    """Revoke a key: from the next request on nobody is known by it, nor by a session that began with it."""
    keys.revoke_key(resources.database, principal, id)
