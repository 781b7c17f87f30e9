"""What the commands of the pages act upon: a served copy with jobs and keys in it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

from hockle_client import Case, Client, Job
from service.access import KeyStore, Scope
from service.jobs import Database
from service.settings import Settings

WEEK = 604800.0
QUICK = {"t_end": 0.3, "output.interval": 0.1, "numerics.intervals": 20}


class Stage:
    """The served copy, and what the names on the pages stand for there."""

    def __init__(self, address: str, data: Path) -> None:
        """It serves at that address, from that directory."""
        self.address, self.data = address, data
        self.environment = {"HOCKLE_SERVER": address, "HOCKLE_DATA": str(data), "MPLBACKEND": "agg"}
        self.client = Client(address)
        self.demonstrated = False

    @cached_property
    def done(self) -> Job:
        """A job that was successful."""
        return self.client.submit(Case.shipped("goyal-2003"), set=QUICK).wait()

    @cached_property
    def ensemble(self) -> str:
        """The id of an ensemble."""
        return self.client.sweep("goyal-2003", {"loads.damping": [0.1, 0.2]}, set=QUICK).id

    @cached_property
    def failed(self) -> Job:
        """A job that failed."""
        return self.client.submit("goyal-2003", set={"numerics.dt_max": 0.0005}, limits={"wall": 0.1}).wait()

    def job_for(self, command: str) -> str:
        """The id of a job that has ended as the command wants it."""
        if command == "delete":
            return self.client.submit(Case.shipped("goyal-2003"), set=QUICK, again=True).wait().id
        return self.failed.id if command == "requeue" else self.done.id

    def new_key(self) -> str:
        """The text of a new API key."""
        database = Database(Settings(data=self.data).database_url)
        try:
            return KeyStore(database).create("pages", frozenset(Scope), WEEK).text
        finally:
            database.close()
