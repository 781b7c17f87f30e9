"""The Celery app: `celery -A worker.app worker`. Its settings come from the environment."""

from __future__ import annotations

import os
import signal
import sys
from functools import cache
from typing import Any

from celery import Celery
from celery.signals import worker_init, worker_process_init

import solver
from service.jobs.doorbell import TASK, celery_settings
from service.jobs.registry import Registry
from service.settings import from_environment
from worker import run
from worker.parent import die_with_parent

settings = from_environment()
app = Celery("hockle")
app.conf.update(celery_settings(settings))
main_process = os.getpid()


@cache
def registry() -> Registry:
    """This process's own connection to the registry: none may cross a fork."""
    return Registry(settings.database_url)


@app.task(name=TASK)
def run_job(job_id: str) -> None:
    """Run one job; its row says the rest."""
    run.run_job(job_id, registry(), settings)


@worker_init.connect
def prepare(**_: Any) -> None:
    """Before the first fork: directories, and the compiled kernels, which the children then share."""
    settings.make_directories()
    if hasattr(solver, "warm"):
        solver.warm()


@worker_process_init.connect
def start_child(**_: Any) -> None:
    """In each child: end when the worker ends, and hand the job back when told to stop."""
    die_with_parent(main_process)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
