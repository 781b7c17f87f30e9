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

    def new_key(self) -> str:
        """The text of a new API key."""
        database = Database(Settings(data=self.data).database_url)
        try:
            return KeyStore(database).create("pages", frozenset(Scope), WEEK).text
        finally:
            database.close()
