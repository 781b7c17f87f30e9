"""The Celery app that `hockle worker` runs. Its settings come from the environment."""

from __future__ import annotations

import gc
import os
import sys
import time
from functools import cache
from typing import Any

from celery import Celery
from celery.signals import (
    setup_logging,
    worker_init,
    worker_process_init,
    worker_process_shutdown,
    worker_shutting_down,
)

import solver
from service.jobs import Database
from service.jobs.doorbell import TASK, Doorbell, celery_settings
from service.jobs.migrations import WrongSchema
from service.jobs.reconciler import ring_for_all
from service.logs import write_json
from service.settings import from_environment
from worker import run, stopping
from worker.beating import Child, Parent, step_of
from worker.parent import die_with_parent

RING_EVERY = 1.0
"""Seconds between two rings of a process, at least: short jobs are not to be slowed down by them."""

try:
    settings = from_environment()
except ValueError as error:
    sys.exit(f"hockle: {error}")
app = Celery("hockle")
app.conf.update(celery_settings(settings))
main_process = os.getpid()
parent = Parent(settings.pulses, settings.lease)
app.steps["consumer"].add(step_of(parent))


@cache
def database() -> Database:
    """The registry. It is opened before the first fork, so that each child has a schema that suits it, also when
    another host has upgraded the tables since; connections it has none then, for they must not cross a fork."""
    opened = Database(settings.database_url)
    opened.close()
    return opened


@cache
def doorbell() -> Doorbell:
    """What a child rings, with connections of its own."""
    return Doorbell(settings)


@cache
def child() -> Child:
    """This process, where it is one of the pool."""
    return Child(database(), settings.pulses, main_process)


@app.task(name=TASK)
def run_next() -> None:
    """Run jobs, one after the other, until none can be had; the registry says which. Between them ring for those that
    wait: when nobody submits, nobody else does for seconds. But not without having run one: messages would go round
    for a job that nobody can take."""
    rung = -RING_EVERY
    while not stopping.pool_ends() and run.run_next(database(), settings):
        if time.monotonic() - rung >= RING_EVERY:
            ring_for_all(database(), doorbell())
            rung = time.monotonic()


@worker_shutting_down.connect
def end_pool(**_: Any) -> None:
    """In the parent that is told to stop."""
    stopping.end_pool()


@setup_logging.connect
def log_as_json(**_: Any) -> None:
    """In place of what Celery would set up."""
    write_json()


@worker_init.connect
def prepare(**_: Any) -> None:
    """Before the first fork: directories, the compiled kernels and the registry, which the children then share."""
    settings.make_directories()
    parent.rounds().start()
    solver.warm()
    try:
        database()  # may fail; then each child tries
    except WrongSchema as error:
        sys.exit(str(error))  # no child could run a job, only take its message from workers that can
    gc.freeze()  # what the children share would be copied as soon as one of them looked for garbage in it
    gc.enable()


@worker_process_init.connect
def start_child(**_: Any) -> None:
    """In each child: end when the worker ends, and show until then that it gets on."""
    die_with_parent(main_process)
    child().start()


@worker_process_shutdown.connect
def end_child(**_: Any) -> None:
    """In each child that is told to end."""
    child().end()
