"""The FastAPI application, put together from its routers."""

from __future__ import annotations

import gc
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache
from importlib.metadata import version

from fastapi import FastAPI

from service.access import KeyStore
from service.access.limits import RateLimit
from service.api import (
    cases,
    data,
    datasets,
    documentation,
    ensemble_data,
    ensemble_events,
    ensembles,
    events,
    film,
    front,
    jobs,
    links,
    operating,
    problems,
    processes,
    scalars,
    shapes,
    stores,
    submitting,
    watching,
)
from service.api.admitted import Admitted
from service.api.description import describe
from service.api.feed import Feed
from service.api.gate import Gate
from service.api.health import Health, Part
from service.api.parts import Parts
from service.cases import load_case, parse_case
from service.jobs import Database, Registry
from service.jobs.doorbell import Doorbell
from service.jobs.reconciler import Reconciler, ring_for_all
from service.jobs.submission import Terms
from service.jobs.submissions import Submissions
from service.results import Datasets
from service.settings import Settings
from service.store import Keeper
from service.webhooks import Notifier

TAGS = [{"name": "jobs", "description": "Submit, follow, list, cancel."},
        {"name": "results", "description": "Datasets, whole or in part."},
        {"name": "ensembles", "description": "Many jobs at once, of cases that differ in some values."},
        {"name": "cases", "description": "What can be simulated, and what it would cost."},
        {"name": "OGC API Processes", "description": "The same jobs as one process of OGC API Processes, Part 1."},
        {"name": "service", "description": "Whether it lives, and how it does."}]
ROUTERS = [part.router for part in (submitting, jobs, events, datasets, data, film, stores, shapes, links, scalars,
                                    ensembles, ensemble_events, ensemble_data, cases, processes, operating,
                                    watching, front, documentation)]
BURST = 10.0  # s of an owner's rate that may be spent at once


def create_app(settings: Settings, keyed: bool = False) -> FastAPI:
    """The API over the registry that `settings` name; it also reconciles while it runs.

    `keyed`: whether every request needs an API key.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        settings.make_directories()
        database = Database(settings.database_url)
        registry, doorbell = Registry(database), Doorbell(settings)
        published = Datasets(settings.datasets, settings.copies, settings.objects)
        terms = Terms(settings.quota, settings.quota_bytes, published.looks_good)
        reconciler = Reconciler(database, doorbell, settings)
        with (reconciler.rounds() as reconciling, Notifier(database).rounds() as notifying,
              Keeper(database, published, settings).rounds(),
              Submissions(database, terms, lambda: ring_for_all(database, doorbell)) as submissions):
            async with Feed(registry).running() as feed:
                limit = RateLimit(settings.rate, int(settings.rate * BURST))
                threads: dict[str, Part] = {"reconciler": reconciling, "notifier": notifying,
                                            "submissions": submissions, "feed": feed}
                with Health(database, doorbell, settings, reconciler.leader, threads) as health:
                    keys = KeyStore(database)
                    app.state.parts = Parts(settings, registry, doorbell, keys, limit, submissions, feed, published,
                                            health, Admitted(keys))
                    _warm_up()
                    async with health.shown():
                        yield
        doorbell.close()
        database.close()

    app = FastAPI(title="hockle", version=version("hockle"), lifespan=lifespan, openapi_tags=TAGS,
                  generate_unique_id_function=lambda route: route.name,
                  openapi_url="/v1/openapi.json", docs_url=None, redoc_url=None, redirect_slashes=False)
    app.openapi = lambda: describe(app, keyed)  # type: ignore[method-assign]
    hosts = {name.strip().lower() for name in settings.hosts.split(",")} - {""}
    app.add_middleware(Gate, keyed=keyed, hosts=hosts)
    problems.install(app)
    for router in ROUTERS:
        app.include_router(router)
    return app


@cache
def _warm_up() -> None:
    """Do now, once, what would hold up the first clients: load what every validation needs (a centreline through points
    needs scipy.interpolate too, a fifth of a second more, and few have one), and set what lives as long as the process
    apart from what is collected (a collection of it all takes 0.1 s, in which nobody is answered)."""
    parse_case(load_case("elastica"))
    if gc.isenabled():  # else nobody has looked since the process began, in which there is next to no garbage yet
        gc.collect()
    gc.freeze()
    gc.enable()
