"""The service as a Python client sees it."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Self

import httpx

from hockle.failure import Failure

DEFAULT_SERVER = "http://127.0.0.1:8000"
POLL = 0.3
ENDED = ("successful", "failed", "dismissed")


class Client:
    """Talks to one server. Every method raises Failure with the sentence for the user."""

    def __init__(self, server: str | None = None) -> None:
        """`server` is an address such as http://127.0.0.1:8000, by default that of HOCKLE_SERVER.

        The API key is that of HOCKLE_KEY, if there is one.
        """
        self.server = (server or os.environ.get("HOCKLE_SERVER") or DEFAULT_SERVER).rstrip("/")
        key = os.environ.get("HOCKLE_KEY")
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._http = httpx.Client(base_url=self.server, headers=headers, timeout=30.0, trust_env=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    def submit(self, case: dict[str, Any], label: str = "", again: bool = False) -> dict[str, Any]:
        """Hand in a case; gives the accepted job, or one that has run the same case, unless it shall run `again`."""
        return self._ask("POST", "/v1/jobs", json={"case": case, "label": label, "reuse": not again})

    def job(self, job_id: str) -> dict[str, Any]:
        """How a job is doing."""
        return self._ask("GET", f"/v1/jobs/{_safe(job_id)}")

    def follow(self, job_id: str) -> Iterator[dict[str, Any]]:
        """The job again and again, until it has ended."""
        while True:
            job = self.job(job_id)
            yield job
            if job["status"] in ENDED:
                return
            time.sleep(POLL)

    def fetch(self, job_id: str, path: Path) -> int:
        """Write a job's dataset to `path`, whole and verified or not at all; gives its size in bytes."""
        beside = path.with_name(f".{path.name}.part")
        try:
            with self._http.stream("GET", f"/v1/jobs/{_safe(job_id)}/dataset") as response:
                if response.status_code != 200:
                    response.read()
                    raise _failure(response)
                digest = _write(beside, response)
            if f'"{digest}"' != response.headers["etag"]:
                raise Failure("the dataset arrived damaged, its sha256 is another: fetch it again")
            beside.replace(path)
        except httpx.TransportError as error:
            raise self._unreachable(error) from None
        except OSError as error:
            raise Failure(f"cannot write {path}: {error}") from None
        finally:
            beside.unlink(missing_ok=True)
        return path.stat().st_size

    def _ask(self, method: str, path: str, **content: Any) -> dict[str, Any]:
        try:
            response = self._http.request(method, path, **content)
        except (httpx.TransportError, httpx.InvalidURL) as error:
            raise self._unreachable(error) from None
        if not response.is_success:
            raise _failure(response)
        told: dict[str, Any] = response.json()
        return told

    def _unreachable(self, error: Exception) -> Failure:
        return Failure(f"no hockle server answers at {self.server} ({error}): start one with hockle serve, "
                       "or name another with --server")


def _write(path: Path, response: httpx.Response) -> str:
    digest = hashlib.sha256()
    with path.open("wb") as file:
        for chunk in response.iter_bytes():
            file.write(chunk)
            digest.update(chunk)
    return digest.hexdigest()


def _failure(response: httpx.Response) -> Failure:
    """The server's problem as one message, with a line for each refused field."""
    if response.headers.get("content-type") != "application/problem+json":
        return Failure(f"the server answered {response.status_code} {response.reason_phrase}")
    problem = response.json()
    faults = problem.get("errors", [])
    lines = [f"  {_place(fault)} {fault['rule']}, got {fault['value']!r}" for fault in faults]
    return Failure("\n".join(["the server refused the case:", *lines]) if faults else problem["detail"])


def _place(fault: dict[str, Any]) -> str:
    return fault.get("pointer", "").removeprefix("/case") or fault.get("parameter") or "the case"


def _safe(job_id: str) -> str:
    if not job_id.isalnum():
        raise Failure(f"a job id has letters and digits only, got {job_id!r}")
    return job_id
