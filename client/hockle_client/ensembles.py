"""Ensembles as a Python program sees them without await.

Written by `make client` from async_ensembles.py: change that one.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from typing_extensions import Self

from hockle_client.documents import EnsembleState, Event, MemberState, SobolIndex, Status
from hockle_client.reading import part_query, read
from hockle_client.showing import Line

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from hockle_client.synchronous import Client

FIRST_POLL, LONGEST_POLL = 0.1, 2.0
"""Seconds between looks at an ensemble that is waited for."""


class Ensemble:
    """Jobs that were handed in together; `state` is all that the server said when it was asked last."""

    def __init__(self, client: Client, state: EnsembleState) -> None:
        self._client, self.state = client, state

    def __repr__(self) -> str:
        return f"<ensemble {self.id}: {self.status}, {self.state.members} members, {self.state.progress:.0%}>"

    @property
    def id(self) -> str:
        """By which the server knows the ensemble."""
        return self.state.id

    @property
    def status(self) -> str:
        """As of a job: running until all members have ended, then the worst of theirs."""
        return self.state.status

    @property
    def ended(self) -> bool:
        """Whether nothing will change any more."""
        return self.state.ended

    def refresh(self) -> Self:
        """Ask how it is. Raises Problem."""
        return self._updated(self._client._ask("GET", self._path()))

    def cancel(self) -> Self:
        """Cancel the members that have not ended. Raises Problem."""
        return self._updated(self._client._ask("POST", self._path("/cancel")))

    def wait(self, timeout: float | None = None, progress: bool = False) -> Self:
        """The ensemble when all members have ended, however. `progress`: with a line on stderr.

        Raises TimeoutError after so many seconds, Problem.
        """
        line, pause, since = Line() if progress else None, FIRST_POLL, time.monotonic()
        while not (self.refresh()).ended:
            if line is not None:
                line.show_many(self.state.ended_members, self.state.members)
            if timeout is not None and time.monotonic() - since > timeout:
                raise TimeoutError(f"ensemble {self.id} has not ended within {timeout:g} s: it is {self.status}")
            time.sleep(pause)
            pause = min(LONGEST_POLL, 2 * pause)
        if line is not None:
            line.show_many(self.state.members, self.state.members)
        return self

    def members(self, status: Status | None = None) -> Iterator[MemberState]:
        """The members in their order, with their values; `Client.job(member.job)` is a member's job. Raises Problem."""
        query = {"limit": "1000", **({} if status is None else {"status": status})}
        page = (self._client._ask("GET", self._path("/members"), params=query)).json()
        while True:
            for member in page["members"]:
                yield MemberState.model_validate(member)
            if page["next"] is None:
                return
            page = (self._client._ask("GET", page["next"])).json()

    def events(self, after: int = 0) -> Iterator[Event]:
        """What happens to it, until all members have ended; a lost connection is made again. Raises Problem."""
        return self._client._events(self._path("/events"), after)

    def scalars(self, *variables: str) -> list[dict[str, Any]]:
        """The last values of variables in time: a record of each member, with its parameters. Raises Problem."""
        query = {"variables": ",".join(variables)}
        members = (self._client._ask("GET", self._path("/scalars"), params=query)).json()["members"]
        return [{"member": member["number"], **member["parameters"],
                 **{name: member[name] for name in ("job", "status", "outcome", "t")}, **member["values"]}
                for member in members]  # fmt: skip

    def csv(self, *variables: str) -> str:
        """The same as a table in CSV. Raises Problem."""
        query = {"variables": ",".join(variables), "format": "csv"}
        return str((self._client._ask("GET", self._path("/scalars"), params=query)).text)

    def table(self, *variables: str) -> pd.DataFrame:
        """The same in pandas, a row for each member. Raises Problem."""
        import pandas as pd

        return pd.DataFrame(self.scalars(*variables)).set_index("member")

    def dataset(self, *variables: str, **part: Any) -> xr.Dataset:
        """Variables of all members in xarray, the parameters as coordinates of `member`. `part` as `Job.values` takes
        it. Raises Problem."""
        query = {**part_query(variables, **part), "format": "netcdf"}
        content = (self._client._ask("GET", self._path("/data"), params=query)).content
        return read(content, f"{self.id}.nc")[list(dict.fromkeys(variables))]

    def sensitivity(self, *variables: str) -> dict[str, dict[str, SobolIndex]]:
        """Sobol's indices of the last values, by variable and parameter; of a `saltelli` sample. Raises Problem."""
        query = {"variables": ",".join(variables)}
        indices = (self._client._ask("GET", self._path("/sensitivity"), params=query)).json()["indices"]
        return {variable: {name: SobolIndex.model_validate(index) for name, index in by_parameter.items()}
                for variable, by_parameter in indices.items()}  # fmt: skip

    def _path(self, suffix: str = "") -> str:
        return f"/v1/ensembles/{self.id}{suffix}"

    def _updated(self, response: Any) -> Self:
        self.state = EnsembleState.model_validate_json(response.content)
        return self
