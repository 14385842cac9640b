"""Links to models: made, listed and revoked by the model's team."""

from http import HTTPStatus

from fastapi import APIRouter, Depends, Request

from treestroke.api.deps import JsonBody, ModelId, ResourcesOf, ShareId, body_of, hosted_only
from treestroke.api.errors import BODY, documented
from treestroke.api.views import share_view
from treestroke.service import shares
from treestroke.share_schemas import ShareInfo, ShareList

_REVOKE = {"revoke_share": {"operationId": "revoke_share", "parameters": {"id": "$response.body#/id"}}}


router = APIRouter(prefix="/v1", tags=["shares"], dependencies=[Depends(hosted_only)])


@router.post(
    "/models/{id}/shares",
    status_code=HTTPStatus.CREATED,
    responses={
        HTTPStatus.CREATED: {"model": ShareInfo, "links": _REVOKE},
        **documented(*BODY, "not_hosted", "not_found", "model_unfinished", "storage_full"),
    },
    openapi_extra=body_of("ShareRequest"),
)
def share_model(request: Request, resources: ResourcesOf, id: ModelId, body: JsonBody) -> ShareInfo:
    """Make a link by which anybody sees a model; its address is told this once."""
    share, token = shares.make_share(resources, id, body)
    return share_view(share, f"{request.base_url}s/{token}")


@router.get("/models/{id}/shares", responses=documented("not_hosted", "not_found"))
def list_shares(resources: ResourcesOf, id: ModelId) -> ShareList:
    """List the links to a model, the 100 newest; those that are over, too."""
    return ShareList(shares=[share_view(share) for share in shares.list_shares(resources, id)])


@router.delete(
    "/shares/{id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=documented("not_hosted", "not_yours", "not_found", "storage_full"),
)
def revoke_share(resources: ResourcesOf, id: ShareId) -> None:
    """Revoke a link: it leads nowhere from now on."""
    shares.revoke_share(resources, id)
