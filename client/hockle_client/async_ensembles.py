"""Ensembles as a Python program sees them, with await: many jobs of one case in which some values differ.

ensembles.py is this without await: `make client` writes it.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator
from typing import TYPE_CHECKING, Any

from typing_extensions import Self

from hockle_client.documents import EnsembleState, Event, MemberState, SobolIndex, Status
from hockle_client.reading import part_query, read
from hockle_client.showing import Line

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from hockle_client.asynchronous import AsyncClient

FIRST_POLL, LONGEST_POLL = 0.1, 2.0
"""Seconds between looks at an ensemble that is waited for."""


class AsyncEnsemble:
    """Jobs that were handed in together; `state` is all that the server said when it was asked last."""

    def __init__(self, client: AsyncClient, state: EnsembleState) -> None:
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

    async def refresh(self) -> Self:
        """Ask how it is. Raises Problem."""
        return self._updated(await self._client._ask("GET", self._path()))

    async def cancel(self) -> Self:
        """Cancel the members that have not ended. Raises Problem."""
        return self._updated(await self._client._ask("POST", self._path("/cancel")))

    async def wait(self, timeout: float | None = None, progress: bool = False) -> Self:
        """The ensemble when all members have ended, however. `progress`: with a line on stderr.

        Raises TimeoutError after so many seconds, Problem.
        """
        line, pause, since = Line() if progress else None, FIRST_POLL, time.monotonic()
        while not (await self.refresh()).ended:
            if line is not None:
                line.show_many(self.state.ended_members, self.state.members)
            if timeout is not None and time.monotonic() - since > timeout:
                raise TimeoutError(f"ensemble {self.id} has not ended within {timeout:g} s: it is {self.status}")
            await asyncio.sleep(pause)
            pause = min(LONGEST_POLL, 2 * pause)
        if line is not None:
            line.show_many(self.state.members, self.state.members)
        return self

    async def members(self, status: Status | None = None) -> AsyncIterator[MemberState]:
        """The members in their order, with their values; `Client.job(member.job)` is a member's job. Raises Problem."""
        query = {"limit": "1000", **({} if status is None else {"status": status})}
        page = (await self._client._ask("GET", self._path("/members"), params=query)).json()
        while True:
            for member in page["members"]:
                yield MemberState.model_validate(member)
            if page["next"] is None:
                return
            page = (await self._client._ask("GET", page["next"])).json()

    def events(self, after: int = 0) -> AsyncIterator[Event]:
        """What happens to it, until all members have ended; a lost connection is made again. Raises Problem."""
        return self._client._events(self._path("/events"), after)

    async def scalars(self, *variables: str) -> list[dict[str, Any]]:
        """The last values of variables in time: a record of each member, with its parameters. Raises Problem."""
        query = {"variables": ",".join(variables)}
        members = (await self._client._ask("GET", self._path("/scalars"), params=query)).json()["members"]
        return [{"member": member["number"], **member["parameters"],
                 **{name: member[name] for name in ("job", "status", "outcome", "t")}, **member["values"]}
                for member in members]  # fmt: skip

    async def csv(self, *variables: str) -> str:
        """The same as a table in CSV. Raises Problem."""
        query = {"variables": ",".join(variables), "format": "csv"}
        return str((await self._client._ask("GET", self._path("/scalars"), params=query)).text)

    async def table(self, *variables: str) -> pd.DataFrame:
        """The same in pandas, a row for each member. Raises Problem."""
        import pandas as pd

        return pd.DataFrame(await self.scalars(*variables)).set_index("member")

    async def dataset(self, *variables: str, **part: Any) -> xr.Dataset:
        """Variables of all members in xarray, the parameters as coordinates of `member`. `part` as `Job.values` takes
        it. Raises Problem."""
        query = {**part_query(variables, **part), "format": "netcdf"}
        content = (await self._client._ask("GET", self._path("/data"), params=query)).content
        return read(content, f"{self.id}.nc")[list(dict.fromkeys(variables))]

    async def sensitivity(self, *variables: str) -> dict[str, dict[str, SobolIndex]]:
        """Sobol's indices of the last values, by variable and parameter; of a `saltelli` sample. Raises Problem."""
        query = {"variables": ",".join(variables)}
        indices = (await self._client._ask("GET", self._path("/sensitivity"), params=query)).json()["indices"]
        return {variable: {name: SobolIndex.model_validate(index) for name, index in by_parameter.items()}
                for variable, by_parameter in indices.items()}  # fmt: skip

    def _path(self, suffix: str = "") -> str:
        return f"/v1/ensembles/{self.id}{suffix}"

    def _updated(self, response: Any) -> Self:
        self.state = EnsembleState.model_validate_json(response.content)
        return self
