"""What schemathesis does beside its own checks: asks what is promised of jobs, with several keys, and keeps count."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

import requests
import schemathesis

ENDED = ("successful", "failed", "dismissed")
KEYS = json.loads(os.environ.get("FUZZ_KEYS", "[]"))  # one of them is sent with each request; null is none
NOWHERE = "http://hooks.example/"  # a name that nobody can have: nothing is sent there
draws = random.Random(1)
statuses = Path("statuses").open("w", buffering=1)  # noqa: SIM115 (as long as the process)
followed = Path("followed").open("w", buffering=1)  # noqa: SIM115
seen: dict[str, str] = {}
dismissed: set[str] = set()


@schemathesis.check
def a_job_ends_once(ctx: Any, response: Any, case: Any) -> None:
    """In place of use_after_free: what is dismissed waits no more, and stays as it ended, until it is deleted."""
    told = list(_jobs(response))
    if case.method == "DELETE" and case.path.endswith("/jobs/{job_id}") and told:
        [(job, _)] = told
        dismissed.add(job)
        told += [one for path in ("/v1/jobs/", "/ogc/jobs/") for one in _asked(path + job, response.request)]
    for job, status in told:
        assert job not in dismissed or status != "accepted", f"{job} was dismissed, and is {status}"
        assert seen.get(job) not in ENDED or status == seen[job], f"{job} was {seen[job]}, and now is {status}"
        seen[job] = status


@schemathesis.check
def a_job_stays_known(ctx: Any, response: Any, case: Any) -> None:
    """Dismissed or not, and by whatever route: what was told of a job, its owner can ask again."""
    job = (case.path_parameters or {}).get("job_id")
    if response.status_code == 404 and job in seen:
        assert response.json()["type"] != "urn:hockle:problem:unknown_job", f"{job} is lost"


def _asked(path: str, request: Any) -> list[tuple[str, str]]:
    """What the service tells of a job right after another request, which it has granted."""
    keys = {name: value for name, value in request.headers.items() if name == "Authorization"}
    answer = requests.get(urljoin(request.url, path), headers=keys, timeout=60)
    assert answer.status_code in (200, 410, 429), f"{path} was dismissed, and is answered {answer.status_code}"
    return list(_jobs(answer))


def _jobs(response: Any) -> Iterator[tuple[str, str]]:
    """The jobs that an answer tells of: id and status."""
    if "application/json" not in response.headers.get("content-type", ""):
        return
    told = response.json()
    listed = told.get("jobs") if isinstance(told, dict) else []
    for one in listed if isinstance(listed, list) else [told]:  # of an ensemble it is their number
        if "status" in one and (job := one.get("id") or one.get("jobID")):
            yield job, one["status"]


class _Keys:
    def get(self, case: Any, ctx: Any) -> list[str | None]:
        return KEYS

    def set(self, case: Any, keys: list[str | None], ctx: Any) -> None:
        if key := draws.choice(keys):
            case.headers["Authorization"] = f"Bearer {key}"


if KEYS:
    schemathesis.auth(retry_on=[])(_Keys)


@schemathesis.hook
def before_call(context: Any, case: Any, kwargs: Any) -> None:
    """Tell the test whose events are followed, that it may end the job; let no webhook lead out of this machine."""
    job = str((case.path_parameters or {}).get("job_id"))
    if case.path == "/v1/jobs/{job_id}/events" and job.isascii() and job.isalnum():
        followed.write(f"{job}\n")
    _turn_webhooks(case.body)


def _turn_webhooks(body: Any) -> None:
    if isinstance(body, dict):
        told = body.get("webhook")
        if isinstance(told, str) and told.startswith("http") and len(told) <= 2000:
            body["webhook"] = NOWHERE
        for below in body.values():
            _turn_webhooks(below)


@schemathesis.hook
def after_call(context: Any, case: Any, response: Any) -> None:
    """Keep count of the answers, so that the test can tell which were met."""
    statuses.write(f"{response.status_code}\n")
