"""Dependencies of routes: the service's parts and whole bodies."""

import os
from contextlib import AbstractAsyncContextManager
from tempfile import gettempdir
from typing import Annotated, Any

from fastapi import Depends, Path, Query, Request
from starlette.datastructures import FormData

from treestroke.api.errors import Refusal
from treestroke.api.following import Watcher
from treestroke.limits import MAX_PHOTO_BYTES
from treestroke.service.dispatch import Dispatcher
from treestroke.service.photos import Resources
from treestroke.service.principals import Principal
from treestroke.service.projects import Projects
from treestroke.service.webhook_calls import Caller
from treestroke.service.webhook_sender import WebhookSender
from treestroke.settings import Settings
from treestroke.store.scope import SERVICE

MAX_PAGE = 100
SIBLINGS_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/SiblingsRequest"},
                "example": {"count": 3, "envelope": "heart", "scene": True},
            }
        },
    }
}
RENAME_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/Rename"},
                "example": {"name": "The old oak"},
            }
        },
    }
}
"""What a new name is sent as, for the API's document."""


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def address_of(request: Request) -> str:
    """Return the address that a request came from."""
    return request.client.host if request.client else ""


def _asker(request: Request) -> Principal | None:
    """Return who was admitted; None where nobody needs to be known."""
    asker: Principal | None = request.state.principal
    return asker


def _principal(request: Request) -> Principal:
    """Return who was admitted."""
    principal: Principal = request.state.principal
    return principal


def _resources(request: Request, principal: "PrincipalOf") -> Resources:
    resources: Resources = request.app.state.resources
    return resources.of(principal.scope)


def _all_resources(request: Request) -> Resources:
    resources: Resources = request.app.state.resources
    return resources.of(SERVICE)


def hosted_only(settings: "SettingsOf") -> None:
    """Refuse what a service without keys has not.

    Raises
    ------
    Refusal
        This service has no keys.
    """
    if not settings.hosted:
        detail = "this service has one person: no keys, members or links to trees; these need TREESTROKE_DATABASE_URL"
        raise Refusal("not_hosted", detail)


def _dispatcher(request: Request) -> Dispatcher:
    dispatcher: Dispatcher = request.app.state.dispatcher
    return dispatcher


def _projects(request: Request) -> Projects:
    projects: Projects = request.app.state.projects
    return projects


def _webhook_caller(request: Request) -> Caller:
    caller: Caller = request.app.state.webhook_caller
    return caller


def _webhook_sender(request: Request) -> WebhookSender:
    sender: WebhookSender = request.app.state.webhook_sender
    return sender


def _watcher(request: Request) -> Watcher:
    watcher: Watcher = request.app.state.watcher
    return watcher


def media_type(request: Request) -> str:
    """Return the media type of a request's body, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def _json_body(request: Request) -> bytes:
    """Return a JSON body as bytes; a tracing process parses it, where a large or hostile one does no harm."""
    if media_type(request) not in ("application/json", ""):
        raise Refusal("unsupported_media_type", "the body must be JSON; send it as application/json")
    return await request.body()


def form_of(request: Request, **limits: int) -> AbstractAsyncContextManager[FormData]:
    """Return a form, read within limits; the folder for its large fields' temporary files is made again if gone."""
    os.makedirs(gettempdir(), 0o700, exist_ok=True)
    return request.form(**limits)


def check_length(photo: bytes) -> None:
    """Raise where a photo has too many bytes.

    Raises
    ------
    Refusal
        The photo is too large.
    """
    if len(photo) > MAX_PHOTO_BYTES:
        raise Refusal("body_too_large", f"the photo has more than {MAX_PHOTO_BYTES // 10**6} MB; save it smaller")


def _id(kind: str) -> Any:
    """Return a path parameter that documents an id's pattern; any other id is not found."""
    return Path(json_schema_extra={"pattern": f"^{kind}_[0-9a-f]{{24}}$"})


def body_of(schema: str) -> dict[str, Any]:
    """Return a required JSON body by its schema's name, for the API's document."""
    content = {"application/json": {"schema": {"$ref": f"#/components/schemas/{schema}"}}}
    return {"requestBody": {"required": True, "content": content}}


def leads_to(*operations: str) -> dict[str, Any]:
    """Return links to the operations that take the id a response holds."""
    return {name: {"operationId": name, "parameters": {"id": "$response.body#/id"}} for name in operations}


Cursor = Annotated[str | None, Query(pattern="^[0-9]{1,18}$", description="``next`` of the page before")]
Limit = Annotated[int, Query(ge=1, le=MAX_PAGE)]
PhotoId = Annotated[str, _id("pho")]
ModelId = Annotated[str, _id("mdl")]
ClipId = Annotated[str, _id("clp")]
UploadId = Annotated[str, _id("upl")]
CaptureId = Annotated[str, _id("cap")]
ShareId = Annotated[str, _id("shr")]
CapturePhotoId = Annotated[str, _id("cph")]
MemberId = Annotated[str, _id("usr")]
KeyId = Annotated[str, _id("key")]
WebhookId = Annotated[str, _id("hook")]
DeliveryId = Annotated[str, _id("msg")]
SettingsOf = Annotated[Settings, Depends(_settings)]
AskerOf = Annotated[Principal | None, Depends(_asker)]
"""Who asks; None without a key."""
PrincipalOf = Annotated[Principal, Depends(_principal)]
ResourcesOf = Annotated[Resources, Depends(_resources)]
AllResources = Annotated[Resources, Depends(_all_resources)]
"""The service's parts with the rows of all teams: for what tells of the service itself."""
ProjectsOf = Annotated[Projects, Depends(_projects)]
DispatcherOf = Annotated[Dispatcher, Depends(_dispatcher)]
WebhookCallerOf = Annotated[Caller, Depends(_webhook_caller)]
WebhookSenderOf = Annotated[WebhookSender, Depends(_webhook_sender)]
WatcherOf = Annotated[Watcher, Depends(_watcher)]
JsonBody = Annotated[bytes, Depends(_json_body)]
