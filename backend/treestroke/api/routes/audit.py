"""What was done in a team."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from treestroke.account_schemas import AuditList
from treestroke.api.account_views import audit_view
from treestroke.api.deps import Limit, ResourcesOf, hosted_only
from treestroke.api.errors import documented
from treestroke.service.audit import list_entries

router = APIRouter(prefix="/v1/audit", tags=["team"], dependencies=[Depends(hosted_only)])
Before = Annotated[str | None, Query(pattern="^[0-9]{1,18}$", description="``next`` of the page before")]


@router.get("", responses=documented("not_hosted", "invalid"))
def list_audit(resources: ResourcesOf, before: Before = None, limit: Limit = 50) -> AuditList:
    """List what was done in the team to keys, members, links and whatever was deleted, the newest first."""
    rows, names, further = list_entries(resources.database, before, limit)
    return AuditList(entries=[audit_view(row, names) for row in rows], next=further)
