"""The FastAPI application, put together from its routers."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import FastAPI

from service.api import cases, datasets, front, jobs, problems
from service.api.guard import LoopbackGuard
from service.api.parts import Parts
from service.jobs import Database, Registry
from service.jobs.doorbell import Doorbell
from service.jobs.reconciler import Reconciler
from service.settings import Settings


def create_app(settings: Settings) -> FastAPI:
    """The API over the registry that `settings` name; it also reconciles while it runs."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        settings.make_directories()
        database = Database(settings.database_url)
        parts = Parts(settings, Registry(database), Doorbell(settings))
        app.state.parts = parts
        with Reconciler(database, parts.doorbell, settings):
            yield
        parts.doorbell.close()
        database.close()

    app = FastAPI(title="hockle", version=version("hockle"), lifespan=lifespan,
                  openapi_url="/v1/openapi.json", docs_url=None, redoc_url=None, redirect_slashes=False)
    app.add_middleware(LoopbackGuard)
    problems.install(app)
    for part in (cases, jobs, datasets, front):
        app.include_router(part.router)
    return app
