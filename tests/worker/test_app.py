"""The Celery app around what workers do."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from sqlalchemy import text

from service.cases import parse_case
from service.jobs import Database, NewJob, Registry, Status

LATER_CHILD = """
import os
from sqlalchemy import text
import solver
solver.warm = lambda: None
from service.jobs import Database
from worker import app
app.prepare()
other = Database(app.settings.database_url)  # another host, where the version is newer
with other.writing() as transaction:
    transaction.connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
other.close()
child = os.fork()
if child == 0:
    app.run_next()
    os._exit(0)
raise SystemExit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""

LATE_START = """
import solver
solver.warm = lambda: None
from celery.signals import worker_init
from worker import app
worker_init.send(sender=None)
"""


def run(code: str, tmp_path: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], env=os.environ | {"HOCKLE_DATA": str(tmp_path)},
                          capture_output=True, text=True, timeout=600)  # fmt: skip


def test_a_child_forked_after_another_host_was_upgraded_still_runs_jobs(tmp_path: Path, case):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    job = Registry(database).submit(NewJob(parse_case(case).document()))
    done = run(LATER_CHILD, tmp_path)
    assert done.returncode == 0, done.stderr
    assert Registry(database).get(job.id).status is Status.SUCCESSFUL
    with database.reading() as connection:
        assert connection.scalar(text("SELECT version_num FROM alembic_version")) == "9999"
    database.close()


def test_a_worker_started_after_another_host_was_upgraded_ends_instead_of_taking_messages_in_vain(tmp_path: Path):
    database = Database(f"sqlite:///{tmp_path}/registry.db")
    with database.writing() as transaction:
        transaction.connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    database.close()
    done = run(LATE_START, tmp_path)
    assert done.returncode == 1
    assert "written by a newer hockle" in done.stderr.splitlines()[-1]
