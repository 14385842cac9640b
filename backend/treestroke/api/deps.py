"""What routes are given: the shelf with everything on it, and bodies read whole."""

from typing import Annotated

from fastapi import Depends, HTTPException, Request

from treestroke.service.dispatch import Dispatcher
from treestroke.service.photos import Shelf
from treestroke.settings import Settings


def _settings(request: Request) -> Settings:
    settings: Settings = request.app.state.settings
    return settings


def _shelf(request: Request) -> Shelf:
    shelf: Shelf = request.app.state.shelf
    return shelf


def _dispatcher(request: Request) -> Dispatcher:
    dispatcher: Dispatcher = request.app.state.dispatcher
    return dispatcher


def media_type(request: Request) -> str:
    """Name the type of a request's body, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def _json_body(request: Request) -> bytes:
    """Read a JSON body; it is parsed where a large or hostile one does no harm."""
    if media_type(request) not in ("application/json", ""):
        raise HTTPException(415, "the body must be application/json")
    return await request.body()


SettingsOf = Annotated[Settings, Depends(_settings)]
ShelfOf = Annotated[Shelf, Depends(_shelf)]
DispatcherOf = Annotated[Dispatcher, Depends(_dispatcher)]
JsonBody = Annotated[bytes, Depends(_json_body)]
