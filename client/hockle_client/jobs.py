"""Jobs as a Python program sees them without await.

Written by `make client` from async_jobs.py: change that one.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from typing_extensions import Self

from hockle_client.case import encoded
from hockle_client.documents import Event, JobState, Link
from hockle_client.handle import JobFacts, safe
from hockle_client.problems import HockleError
from hockle_client.reading import opened_file, part_query, read
from hockle_client.schema import Setting
from hockle_client.showing import Line

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from hockle_client.synchronous import Client

FIRST_POLL, LONGEST_POLL = 0.05, 1.0
"""Seconds between looks at a job that is waited for."""
SHAPES = {".glb": "gltf", ".zip": "vtk"}


class Job(JobFacts):
    """One job on a server."""

    def __init__(self, client: Client, state: JobState) -> None:
        self._client, self.state = client, state

    def refresh(self) -> Self:
        """Ask how it is. Raises Problem."""
        self.state = self._client._state(self.id)
        return self

    def events(self, after: int = 0) -> Iterator[Event]:
        """What happens to the job, as it happens, until its end; a lost connection is made again. Raises Problem.

        `after`: only what came after the event with this id.
        """
        return self._client._events(f"/v1/jobs/{self.id}/events", after)

    def watch(self) -> Iterator[Self]:
        """The job now, and each time that it has changed, until it has ended. Raises Problem."""
        yield self.refresh()
        if self.ended:
            return
        for event in self.events():
            if event.kind == "progress":
                self.state = JobState.model_validate(event.data)
                yield self
        yield self.refresh()

    def wait(self, timeout: float | None = None, progress: bool = False) -> Self:
        """The job when it has ended, however it has ended. `progress`: with a line on stderr.

        Raises TimeoutError after so many seconds, Problem.
        """
        line, pause, since = Line() if progress else None, FIRST_POLL, time.monotonic()
        while not self.ended:
            self.refresh()
            if line:
                line.show(self.state)
            if not self.ended and timeout is not None and time.monotonic() - since > timeout:
                raise TimeoutError(f"job {self.id} has not ended within {timeout:g} s: it is {self.status}")
            if not self.ended:
                time.sleep(pause)
            pause = min(LONGEST_POLL, 2 * pause)
        return self

    def cancel(self) -> Self:
        """Cancel the job; an ended one stays as it is. Raises Problem."""
        return self._do("POST", "cancel")

    def pin(self) -> Self:
        """Have the job kept, whatever the server's rules. Raises Problem."""
        return self._do("PUT", "pin")

    def unpin(self) -> Self:
        """Let it be deleted. Raises Problem."""
        return self._do("DELETE", "pin")

    def delete(self) -> None:
        """Delete the job, which must have ended, and its dataset, for ever. Raises Problem."""
        if not (self.refresh()).ended:
            raise HockleError(f"job {self.id} is {self.status}: cancel it, and wait for its end")
        self._client._ask("DELETE", f"/v1/jobs/{self.id}")

    def _do(self, method: str, action: str) -> Self:
        response = self._client._ask(method, f"/v1/jobs/{self.id}/{action}")
        self.state = JobState.model_validate_json(response.content)
        return self

    def requeue(self) -> Job:
        """Have the case of this job, which has failed, run once more; gives the new job. Raises Problem."""
        response = self._client._ask("POST", f"/v1/jobs/{self.id}/requeue")
        return Job(self._client, JobState.model_validate_json(response.content))

    def again(self, *, set: Mapping[Setting, Any] | Mapping[str, Any] = {}, label: str = "", priority: int = 0,
              limits: Mapping[str, float] = {}) -> Job:
        """Hand in its case once more with some values changed, as `t_end` to go on beyond its end.

        The new job begins where this one had come when something begins to differ, which gives the same bits. Raises
        Problem.
        """
        return self._again({"set": dict(set)}, label=label, priority=priority, limits=dict(limits))

    def fork(self, at: float, *, start: Mapping[str, Any] = {}, end: Mapping[str, Any] = {},
             set: Mapping[Setting, Any] | Mapping[str, Any] = {}, label: str = "", priority: int = 0,
             limits: Mapping[str, float] = {}) -> Job:
        """The same with its ends moved otherwise from the time `at` (s) on: job.fork(10.0, end={"omega3": 0.0}).

        Raises Problem.
        """
        change = {"set": dict(set), "fork": {"at": at, "start": dict(start), "end": dict(end)}}
        return self._again(change, label=label, priority=priority, limits=dict(limits))

    def _again(self, change: dict[str, Any], **more: Any) -> Job:
        headers = {"Idempotency-Key": str(uuid.uuid4())}
        body = encoded({"job": self.id, **change, **more})
        response = self._client._ask("POST", "/v1/jobs", body=body, headers=headers)
        return Job(self._client, JobState.model_validate_json(response.content))

    def case(self) -> dict[str, Any]:
        """The case with every default filled in, as it is run. Raises Problem."""
        case: dict[str, Any] = (self._client._ask("GET", f"/v1/jobs/{self.id}/case")).json()
        return case

    def fetch(self, path: str | Path) -> int:
        """Write the dataset to a file, whole and verified or not at all; gives its bytes. Raises Problem, OSError."""
        path = Path(path)
        beside = path.with_name(f".{path.name}.part")
        try:
            with beside.open("wb") as file:
                size = self._client._download(self.id, file)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)
        return size

    def export(self, path: str | Path) -> int:
        """Write the moving rod for other programs, by the file's suffix: .glb (glTF), .zip (VTK, for ParaView); also of
        a job that runs. Gives its bytes. Raises Problem, HockleError, OSError."""
        path = Path(path)
        if path.suffix not in SHAPES:
            raise HockleError(f"path must end in {' or '.join(SHAPES)}, got {path.name}")
        content = (self._client._ask("GET", f"/v1/jobs/{self.id}/{SHAPES[path.suffix]}")).content
        path.write_bytes(content)
        return len(content)

    def dataset(self) -> xr.Dataset:
        """The whole dataset in xarray, its file a temporary one: values are in memory once they are looked at.

        Raises Problem, OSError.
        """
        with TemporaryDirectory(prefix="hockle-", ignore_cleanup_errors=True) as directory:
            path = Path(directory, f"{self.id}.nc")
            self.fetch(path)
            return opened_file(path)  # which its name may leave

    def values(self, *variables: str, t_min: float | None = None, t_max: float | None = None,
               s_min: float | None = None, s_max: float | None = None, time_stride: int = 1,
               s_stride: int = 1) -> dict[str, Any]:
        """Some variables in ranges of time (s) and arclength (m), every stride-th, as plain data. Raises Problem."""
        query = part_query(variables, t_min, t_max, s_min, s_max, time_stride, s_stride)
        part: dict[str, Any] = (self._client._ask("GET", f"/v1/jobs/{self.id}/data", params=query)).json()
        return part

    def data(self, *variables: str, **part: Any) -> xr.Dataset:
        """The same in xarray: only this is transferred. `part` as `values` takes it. Raises Problem."""
        query = {**part_query(variables, **part), "format": "netcdf"}
        content = (self._client._ask("GET", f"/v1/jobs/{self.id}/data", params=query)).content
        return read(content, f"{self.id}.nc")[list(dict.fromkeys(variables))]

    def table(self, *variables: str, **part: Any) -> pd.DataFrame:
        """The same in pandas, a row for each time (and node, and component). Raises Problem."""
        return (self.data(*variables, **part)).to_dataframe()

    def link(self, seconds: float = 86400.0) -> Link:
        """An address by which anybody reads this dataset for so long, without a key. Raises Problem."""
        body = encoded({"seconds": seconds})
        created = (self._client._ask("POST", f"/v1/jobs/{self.id}/links", body=body)).json()
        return self._linked(created)

    def links(self) -> list[Link]:
        """The links to this dataset, those that are good no more included. Raises Problem."""
        document = (self._client._ask("GET", f"/v1/jobs/{self.id}/links")).json()
        return [self._linked(link) for link in document["links"]]

    def revoke(self, link: Link | str) -> None:
        """Make a link useless from now on. Raises Problem."""
        link_id = link if isinstance(link, str) else link.id
        self._client._ask("DELETE", f"/v1/jobs/{self.id}/links/{safe(link_id)}")

    def _linked(self, link: dict[str, Any]) -> Link:
        addresses = {"url": link.pop("href", None)} | {name: link.pop(name, None) for name in ("zarr", "opendap")}
        urls = {name: f"{self._client.url}{address}" if address else "" for name, address in addresses.items()}
        return Link(**urls, **link)
