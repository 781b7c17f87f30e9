"""A worker, in a process of its own, that is killed after some steps."""

from __future__ import annotations

import os
import signal
from multiprocessing import get_context
from pathlib import Path

from service.jobs import Database
from service.settings import Settings
from solver import Run, Scene, simulate
from worker import attempt, run

APART = get_context("forkserver")
APART.set_forkserver_preload(["worker.run"])  # it takes two seconds to load; each worker is forked from what has


def killed_after(steps: int, data: Path, checkpoint: float) -> int | None:
    """Run a job of the registry in that directory, with checkpoints so often (s); gives the process's exit code."""
    process = APART.Process(target=_run, args=(steps, data, checkpoint))
    process.start()
    process.join()
    return process.exitcode


def _run(steps: int, data: Path, checkpoint: float) -> None:
    def begin(scene: Scene) -> Run:
        simulation, taken = simulate(scene), 0
        advance = simulation.advance

        def watched() -> object:
            nonlocal taken
            taken += 1
            if taken > steps:
                os.kill(os.getpid(), signal.SIGKILL)
            return advance()

        simulation.advance = watched
        return simulation

    attempt.simulate = begin
    attempt.SHARE = 1e9  # checkpoints after every step, whatever they cost
    settings = Settings(data, lease=1000.0, checkpoint=checkpoint)
    run.run_next(Database(settings.database_url), settings)
