"""The application: the only place where it is wired."""

import pkgutil
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import import_module

from anyio.to_thread import run_sync
from fastapi import APIRouter, FastAPI
from fastapi.routing import APIRoute
from starlette.middleware import Middleware

import app.routers
from app import __version__
from app.access.guard import TokenGuard
from app.container import Container
from app.middleware import BodyGuard, FaultGuard, LoopbackGuard
from app.openapi_schema import install_openapi, operation_id
from app.pages.security import PageHeaders
from app.pages.site import add_pages
from app.problem_handlers import add_problem_handlers
from app.settings import Settings
from app.telemetry.requests import Observed


def create_app(settings: Settings | None = None) -> FastAPI:
    """The ASGI application; without `settings` they come from the environment.

    Nothing is read or written before the server starts the lifespan.
    """
    settings = settings or Settings()
    container = Container(settings)
    application = FastAPI(
        title="lpv-oed",
        version=__version__,
        lifespan=_lifespan,
        middleware=_guards(container),
        generate_unique_id_function=operation_id,
        separate_input_output_schemas=False,
        redirect_slashes=False,
        openapi_url="/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
    )
    application.state.container = container
    add_problem_handlers(application)
    for router in _routers():
        application.include_router(router, prefix="/v1")
    add_pages(application)
    install_openapi(application)
    return application


@asynccontextmanager
async def _lifespan(application: FastAPI) -> AsyncIterator[None]:
    container: Container = application.state.container
    await run_sync(container.start)
    try:
        yield
    finally:
        await run_sync(container.stop)


def _guards(container: Container) -> list[Middleware]:
    """Outermost first."""
    settings = container.settings
    who = Middleware(LoopbackGuard)
    if settings.bearer_token is not None:
        who = Middleware(TokenGuard, tokens=container.tokens, audit=container.audit)
    body = Middleware(BodyGuard, most_bytes=settings.max_body_bytes, seconds=settings.request_seconds)
    return [Middleware(Observed, metrics=container.metrics), Middleware(FaultGuard), Middleware(PageHeaders), who, body]


def _routers() -> list[APIRouter]:
    names = sorted(module.name for module in pkgutil.iter_modules(app.routers.__path__))
    modules = [import_module(f"app.routers.{name}") for name in names]
    routers: list[APIRouter] = [module.router for module in modules if hasattr(module, "router")]
    for route in (route for router in routers for route in router.routes if isinstance(route, APIRoute)):
        route.response_model_exclude_none = True  # what does not apply is absent; nulls within lists stay
    return routers
