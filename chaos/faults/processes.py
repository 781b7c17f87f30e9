"""Processes are killed, stopped for a while, or told to stop."""

from __future__ import annotations

import signal
import time

from sqlalchemy import func, select

from chaos.faults.database import locked
from chaos.faults.target import PUT_TOGETHER, RENAMED, SOON, Target
from chaos.served import send
from service.jobs import Database
from service.jobs.tables import jobs


def kill_child(target: Target) -> bool:
    """kill -9 of a process that runs a job."""
    picked = target.pick()
    return picked is not None and send(picked[1], signal.SIGKILL)


def kill_worker(target: Target) -> bool:
    """kill -9 of the Celery worker, with its children."""
    return send(target.served.worker(), signal.SIGKILL)


def kill_api(target: Target) -> bool:
    """kill -9 of one of the API's processes, whatever it does."""
    apis = target.served.apis()
    return bool(apis) and send(target.random.choice(apis), signal.SIGKILL)


def kill_api_before_commit(target: Target) -> bool:
    """kill -9 of all of the API's processes while one has a job that it cannot commit."""
    with locked(target):
        target.in_a_while(0.0, target.submit)
        time.sleep(0.2)
        return _kill(target.served.apis())


def kill_api_after_commit(target: Target) -> bool:
    """kill -9 of all of the API's processes as soon as a job is committed, so likely before its answer."""
    apis, before = target.served.apis(), _count_jobs(target.database)
    target.in_a_while(0.0, target.submit)
    deadline = time.monotonic() + SOON
    while _count_jobs(target.database) == before:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.0005)
    return _kill(apis)


def _kill(pids: list[int]) -> bool:
    return bool([pid for pid in pids if send(pid, signal.SIGKILL)])


def _count_jobs(database: Database) -> int:
    with database.reading() as connection:
        return connection.scalar(select(func.count()).select_from(jobs)) or 0


def kill_supervisor(target: Target) -> bool:
    """kill -9 of `hockle serve`, with all it started; then it is started again."""
    target.served.end(signal.SIGKILL)
    target.served.start()
    return True


def stop_gracefully(target: Target) -> bool:
    """Ctrl-C in the middle of runs; then it is started again."""
    target.served.stop()
    target.served.start()
    return True


def stop_child_past_its_lease(target: Target) -> bool:
    """SIGSTOP of a process that runs a job until long after its lease, then SIGCONT."""
    picked = target.pick()
    if picked is None or not send(picked[1], signal.SIGSTOP):
        return False
    target.in_a_while(target.lease * target.random.uniform(1.2, 2.0), lambda: send(picked[1], signal.SIGCONT))
    return True


def stop_worker_past_its_lease(target: Target) -> bool:
    """The same of the Celery worker and all of its children."""
    worker = target.served.worker()
    stopped = [pid for pid in (worker, *target.served.children()) if send(pid, signal.SIGSTOP)]
    target.in_a_while(target.lease * target.random.uniform(1.2, 2.0),
                      lambda: [send(pid, signal.SIGCONT) for pid in reversed(stopped)])
    return bool(stopped)


def stop_api_past_its_lease(target: Target) -> bool:
    """The same of one of the API's processes, which may be the one that leads."""
    apis = target.served.apis()
    if not apis or not send(pid := target.random.choice(apis), signal.SIGSTOP):
        return False
    target.in_a_while(target.lease * target.random.uniform(1.2, 2.0), lambda: send(pid, signal.SIGCONT))
    return True


def stop_child_for_a_moment(target: Target) -> bool:
    """SIGSTOP and SIGCONT within the lease."""
    picked = target.pick()
    if picked is None or not send(picked[1], signal.SIGSTOP):
        return False
    target.in_a_while(0.3 * target.lease, lambda: send(picked[1], signal.SIGCONT))
    return True


def kill_at_rename(target: Target) -> bool:
    """kill -9 while a dataset is put together, or between its rename and the commit of its row."""
    ending = target.ending(target.random.choice([PUT_TOGETHER, RENAMED]))
    return ending is not None and send(ending[1], signal.SIGKILL)


def jump_clock(target: Target) -> bool:
    """The clock of every process goes wrong by up to a day."""
    target.served.clock.write_text(str(target.random.uniform(-86400, 86400)))
    return True
