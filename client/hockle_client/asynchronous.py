"""The service as a Python program sees it, with await.

synchronous.py is this without await: `make client` writes it.
"""

from __future__ import annotations

import asyncio
import os
import time
import uuid
from collections.abc import AsyncIterator, Iterable, Mapping
from datetime import datetime
from typing import TYPE_CHECKING, Any, BinaryIO
from urllib.parse import quote

import httpx
from typing_extensions import Self

from hockle_client.async_ensembles import AsyncEnsemble
from hockle_client.async_jobs import AsyncJob
from hockle_client.case import CaseLike, request_of
from hockle_client.design import Members, Method, Parameters, sweep_request
from hockle_client.documents import Cost, EnsembleState, Event, JobState, Status, Verdict, Workforce
from hockle_client.handle import safe
from hockle_client.problems import HockleError, Unreachable, problem_of
from hockle_client.retrying import Retries
from hockle_client.schema import Setting
from hockle_client.showing import Line
from hockle_client.streaming import Download, Events
from hockle_client.trust import trusted

if TYPE_CHECKING:
    pass

SILENCE = 45.0
"""Seconds without a sign of life after which a connection is taken for dead; a stream of events has one every 15."""
SCALARS_AT_ONCE = 100


class AsyncClient:
    """One server. Requests that meet a lost connection or a busy server are made again; that runs no case twice."""

    def __init__(self, url: str | None = None, key: str | None = None, patience: float = 60.0) -> None:
        """`url` as http://127.0.0.1:8000, `key` as `hockle keys create` prints it; else HOCKLE_SERVER and HOCKLE_KEY.

        `patience`: for how long one request is made again, s.
        """
        self.url = (url or os.environ.get("HOCKLE_SERVER") or "http://127.0.0.1:8000").rstrip("/")
        key = key or os.environ.get("HOCKLE_KEY")
        self.patience = patience
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._http = httpx.AsyncClient(
            base_url=self.url, headers=headers, timeout=SILENCE, trust_env=False, verify=trusted()
        )

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.aclose()

    async def aclose(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def submit(self, case: CaseLike, *, set: Mapping[Setting, Any] | Mapping[str, Any] = {}, label: str = "",
                     priority: int = 0, limits: Mapping[str, float] = {}, again: bool = False,
                     idempotency_key: str | None = None) -> AsyncJob:
        """Hand in a case, with some values `set` by dotted keys; gives the job that runs it, or has run the same case.

        `again`: run it even so. `limits`: `wall` (s), `memory`, `disk` (bytes), less than the service's. Submissions
        with one `idempotency_key` are one job, also of several programs. Raises Problem.
        """
        body = request_of(case, set, label=label, priority=priority, reuse=not again, limits=dict(limits))
        headers = {"Idempotency-Key": idempotency_key or str(uuid.uuid4())}
        response = await self._ask("POST", "/v1/jobs", body=body, headers=headers)
        return AsyncJob(self, JobState.model_validate_json(response.content))

    async def validate(self, case: CaseLike, *, set: Mapping[Setting, Any] | Mapping[str, Any] = {}) -> Verdict:
        """The case as the server understands it, its cost and warnings; nothing is run. Raises Problem."""
        response = await self._ask("POST", "/v1/validate", body=request_of(case, set))
        return Verdict.model_validate_json(response.content)

    async def cost(self, case: CaseLike, *, set: Mapping[Setting, Any] | Mapping[str, Any] = {}) -> Cost:
        """What the case would cost. Raises Problem."""
        verdict = await self.validate(case, set=set)
        return verdict.cost

    async def shipped(self) -> dict[str, str]:
        """Name and title of each case that comes with hockle."""
        titles: dict[str, str] = (await self._ask("GET", "/v1/cases")).json()
        return titles

    async def shipped_case(self, name: str) -> dict[str, Any]:
        """A case that comes with hockle. Raises Problem."""
        case: dict[str, Any] = (await self._ask("GET", f"/v1/cases/{safe(name)}")).json()
        return case

    async def job(self, job_id: str) -> AsyncJob:
        """One job. Raises Problem."""
        return AsyncJob(self, await self._state(job_id))

    async def jobs(self, *, status: Status | None = None, label: str | None = None, owner: str | None = None,
                   since: datetime | None = None, until: datetime | None = None,
                   ensemble: str | None = None) -> AsyncIterator[AsyncJob]:
        """All jobs that meet these conditions, newest first; `since` and `until` are aware times, `ensemble` is the id
        of the ensemble whose members are listed. Raises Problem."""
        filters = {"limit": "200", "status": status, "label": label, "owner": owner, "ensemble": ensemble,
                   "since": since and since.isoformat(), "until": until and until.isoformat()}
        query = {name: value for name, value in filters.items() if value is not None}
        page = (await self._ask("GET", "/v1/jobs", params=query)).json()
        while True:
            for state in page["jobs"]:
                yield AsyncJob(self, JobState.model_validate(state))
            if page["next"] is None:
                return
            page = (await self._ask("GET", page["next"])).json()

    async def sweep(self, case: CaseLike, parameters: Parameters | None = None, *,
                    members: Members = (), sample: Method | None = None,
                    size: int | None = None, seed: int = 0,
                    set: Mapping[Setting, Any] | Mapping[str, Any] = {}, title: str = "", label: str = "",
                    priority: int = 0, limits: Mapping[str, float] = {}, again: bool = False,
                    idempotency_key: str | None = None) -> AsyncEnsemble:
        """Hand in a case many times, with other values of some `parameters`, which are dotted keys.

        Lists of values make a grid; `Range`s are filled by a `sample` of a `size`; `members` have their values one by
        one. A parameter may have a name of its own: {"damping": {"path": "loads.damping", "values": [0, 1]}}.
        `again`: run also the cases that have run before. Raises Problem.
        """
        body = sweep_request(case, set, parameters or {}, members, sample=sample, size=size, seed=seed, title=title,
                             label=label, priority=priority, limits=dict(limits), reuse=not again)
        headers = {"Idempotency-Key": idempotency_key or str(uuid.uuid4())}
        response = await self._ask("POST", "/v1/ensembles", body=body, headers=headers)
        return AsyncEnsemble(self, EnsembleState.model_validate_json(response.content))

    async def ensemble(self, ensemble_id: str) -> AsyncEnsemble:
        """One ensemble. Raises Problem."""
        response = await self._ask("GET", f"/v1/ensembles/{safe(ensemble_id)}")
        return AsyncEnsemble(self, EnsembleState.model_validate_json(response.content))

    async def ensembles(self) -> AsyncIterator[AsyncEnsemble]:
        """All ensembles, newest first. Raises Problem."""
        page = (await self._ask("GET", "/v1/ensembles")).json()
        while True:
            for state in page["ensembles"]:
                yield AsyncEnsemble(self, EnsembleState.model_validate(state))
            if page["next"] is None:
                return
            page = (await self._ask("GET", page["next"])).json()

    async def wait(self, jobs: Iterable[AsyncJob], timeout: float | None = None,
                   progress: bool = False) -> list[AsyncJob]:
        """The jobs when all have ended, however. Raises TimeoutError after so many seconds."""
        deadline = None if timeout is None else time.monotonic() + timeout
        line, waited = Line() if progress else None, list(jobs)
        for ended, job in enumerate(waited):
            if line is not None:
                line.show_many(ended, len(waited))
            await job.wait(None if deadline is None else max(0.0, deadline - time.monotonic()))
        if line is not None:
            line.show_many(len(waited), len(waited))
        return waited

    async def scalars(self, jobs: Iterable[AsyncJob | str], *variables: str) -> list[dict[str, Any]]:
        """The last values of variables in time of many jobs: a record of each, with its id, label, status and outcome.

        pandas.DataFrame takes the records as they are. A value is None where a job has no dataset. Raises Problem.
        """
        ids = [job if isinstance(job, str) else job.id for job in jobs]
        records: list[dict[str, Any]] = []
        for start in range(0, len(ids), SCALARS_AT_ONCE):
            query = {"jobs": ",".join(ids[start : start + SCALARS_AT_ONCE]), "variables": ",".join(variables)}
            rows = (await self._ask("GET", "/v1/scalars", params=query)).json()["jobs"]
            records += [{**{name: value for name, value in row.items() if name != "values"}, **row["values"]}
                        for row in rows]
        return records

    async def workforce(self) -> Workforce:
        """How many jobs wait and run, and which hosts have workers or are paused; for operators. Raises Problem."""
        return Workforce.model_validate_json((await self._ask("GET", "/v1/queue")).content)

    async def pause(self, host: str | None = None, *, drain: bool = False) -> Workforce:
        """Have the workers of a host, or all, take no job from now on; `drain`: also hand back what they run.

        Raises Problem.
        """
        response = await self._ask("PUT", _pause_of(host), params={"drain": str(drain).lower()})
        return Workforce.model_validate_json(response.content)

    async def resume(self, host: str | None = None) -> Workforce:
        """Have them take jobs again. Raises Problem."""
        return Workforce.model_validate_json((await self._ask("DELETE", _pause_of(host))).content)

    async def _state(self, job_id: str) -> JobState:
        response = await self._ask("GET", f"/v1/jobs/{safe(job_id)}")
        return JobState.model_validate_json(response.content)

    async def _ask(self, method: str, path: str, *, params: Mapping[str, Any] | None = None,
                   body: bytes | None = None, headers: Mapping[str, str] = {}) -> httpx.Response:
        """The answer to one request, made again while that may help. Raises Problem, Unreachable."""
        retries = Retries(self.patience)
        headers = {**headers, **({} if body is None else {"Content-Type": "application/json"})}
        while True:
            try:
                response = await self._http.request(method, path, params=params, content=body, headers=headers)
            except httpx.TransportError as error:
                refused: HockleError = Unreachable(self.url, error)
            else:
                if response.is_success:
                    return response
                refused = problem_of(response)
            await asyncio.sleep(retries.after(refused))

    async def _events(self, path: str, last_id: int) -> AsyncIterator[Event]:
        retries = Retries(self.patience)
        while True:
            try:
                async with self._http.stream("GET", path, headers={"Last-Event-ID": str(last_id)}) as response:
                    if response.status_code == 204:
                        return
                    if response.status_code != 200:
                        await response.aread()
                        raise problem_of(response)
                    retries.begin()
                    events = Events()
                    async for line in response.aiter_lines():
                        event = events.take(line)
                        if event is not None:
                            last_id = event.id
                            yield event
                refused: HockleError = Unreachable(self.url, httpx.ReadError("the events broke off"))
            except httpx.TransportError as error:
                refused = Unreachable(self.url, error)
            except HockleError as error:
                refused = error
            await asyncio.sleep(retries.after(refused))

    async def _download(self, job_id: str, file: BinaryIO) -> int:
        path, retries, download = f"/v1/jobs/{safe(job_id)}/dataset", Retries(self.patience), Download(file)
        while True:
            try:
                async with self._http.stream("GET", path, headers=download.headers) as response:
                    if not response.is_success:
                        await response.aread()
                        raise problem_of(response)
                    download.begin(response)
                    async for chunk in response.aiter_bytes():
                        download.take(chunk)
                download.check()
                return download.size
            except httpx.TransportError as error:
                refused: HockleError = Unreachable(self.url, error)
            except HockleError as error:
                refused = error
            await asyncio.sleep(retries.after(refused))


def _pause_of(host: str | None) -> str:
    return "/v1/queue/pause" if host is None else f"/v1/hosts/{quote(host, safe='')}/pause"
