"""The routes of the workbench."""

from collections.abc import Awaitable, Callable
from functools import cache
from typing import TYPE_CHECKING

from fastapi import APIRouter, FastAPI, Request, Response
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse

from app import __version__
from app.errors import NotFoundError
from app.pages.assets import assets, plotly_address, plotly_file
from app.pages.page import Page, menu, pages

if TYPE_CHECKING:
    from jinja2 import Environment

FOR_EVER = {"Cache-Control": "public, max-age=31536000, immutable"}
NEVER = {"Cache-Control": "no-cache"}


def add_pages(application: FastAPI) -> None:
    """Add the pages and what they are made of; they hold no data and are no part of the HTTP interface."""
    router = APIRouter(include_in_schema=False)
    router.add_api_route("/", _home, methods=["GET"])
    for page in pages():
        router.add_api_route(page.path, _shell(page), methods=["GET"], response_class=HTMLResponse)
    router.add_api_route(plotly_address(), _plotly, methods=["GET"])
    router.add_api_route("/static/{version}/{path:path}", _asset, methods=["GET"])
    application.include_router(router)


def render(page: Page, parameters: dict[str, str]) -> str:
    """The shell of a page."""
    return (
        _templates()
        .get_template(page.template)
        .render(
            page=page,
            parameters=parameters,
            context={**parameters, "plotly": plotly_address()},
            service_menu=menu("service"),
            plant_menu=menu("plant") if "plantId" in parameters else (),
            static=assets().prefix,
            version=__version__,
        )
    )


def _shell(page: Page) -> Callable[[Request], Awaitable[HTMLResponse]]:
    async def get_page(request: Request) -> HTMLResponse:
        return HTMLResponse(render(page, dict(request.path_params)), headers=NEVER)

    return get_page


async def _home() -> RedirectResponse:
    return RedirectResponse("/plants")


async def _asset(version: str, path: str) -> Response:
    found = assets()
    if path not in found.files:
        raise NotFoundError(f"there is no file {path!r}")
    content, media_type = found.files[path]
    return Response(content, media_type=media_type, headers=FOR_EVER if version == found.version else NEVER)


def _plotly() -> FileResponse:
    return FileResponse(plotly_file(), media_type="text/javascript; charset=utf-8", headers=FOR_EVER)


@cache
def _templates() -> "Environment":
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("app.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["filled"] = _filled
    return environment


def _filled(path: str, parameters: dict[str, str]) -> str:
    """A path with its parameters."""
    for name, value in parameters.items():
        path = path.replace(f"{{{name}}}", value)
    return path
