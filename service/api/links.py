"""/v1/jobs/{id}/links: who may share a dataset; /v1/shared/{token}: the dataset, for whoever has the link."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from math import ceil
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from service.access.links import Link, LinkStore
from service.api.bodies import json_object
from service.api.datasets import FILE, dataset_of, whole
from service.api.description import NOT_MODIFIED, problems
from service.api.gate import SHARED
from service.api.parts import InParts, Jobs, OwnJobs, Parts, Submitter
from service.api.problems import Problem
from service.api.stores import BYTES, Dap, dap_of, zarr_of
from service.cases import CaseError
from service.jobs import Job
from service.meaning import means

DAY = 86400.0
LONGEST = 366 * DAY
ENDS = {"href": ".nc", "zarr": "/zarr", "opendap": "/opendap"}
router = APIRouter(tags=["results"])


class LinkRequest(BaseModel):
    """How long a link is good."""

    model_config = ConfigDict(extra="forbid", strict=True)
    seconds: Annotated[
        float, Field(gt=0, le=LONGEST, allow_inf_nan=False), means("how long the link is good", "s")
    ] = DAY


class LinkDocument(BaseModel):
    """A link to a dataset. `href`, `zarr` and `opendap` are told once, when the link is made: with them anybody reads
    the dataset, the file itself, a Zarr store or by OPeNDAP."""

    id: str
    href: str | None
    zarr: str | None
    opendap: str | None
    created: datetime
    expires: datetime
    revoked: datetime | None


class LinksDocument(BaseModel):
    """The links to a job's dataset, oldest first, those that are good no more included."""

    links: list[LinkDocument]


LINK_BODY = {"requestBody": {"required": True, "content": {"application/json": {
    "schema": LinkRequest.model_json_schema(), "examples": {"hour": {"value": {"seconds": 3600}}}}}}}


@router.post("/v1/jobs/{job_id}/links", status_code=201, openapi_extra=LINK_BODY,
             responses=problems(400, 404, 409, 413, 415, 422))
def share(job_id: str, parts: InParts, jobs: OwnJobs, caller: Submitter,
          body: Annotated[dict[str, Any], Depends(json_object)]) -> LinkDocument:
    """Make a link by which anybody reads this job's dataset, and nothing else, until it expires or is revoked.

    It needs no key: `xarray.open_dataset(address + "#mode=bytes")` and `curl -O` take it as it is.
    """
    try:
        request = LinkRequest.model_validate(body)
    except ValidationError as error:
        raise CaseError.of(error) from None
    dataset_of(jobs.get(job_id), parts)
    link, token = LinkStore(parts.registry.database).create(job_id, caller.actor, request.seconds)
    return _document(link, f"{SHARED}{token}")


@router.get("/v1/jobs/{job_id}/links", responses=problems(404))
def list_links(job_id: str, parts: InParts, jobs: Jobs) -> LinksDocument:
    """The links to this job's dataset, without their addresses, which nobody keeps."""
    links = LinkStore(parts.registry.database).of(jobs.get(job_id).id)
    return LinksDocument(links=[_document(link) for link in links])


@router.delete("/v1/jobs/{job_id}/links/{link_id}", status_code=204, response_class=Response,
               responses=problems(404))
def revoke(job_id: str, link_id: str, parts: InParts, jobs: OwnJobs, caller: Submitter) -> None:
    """Make a link useless from now on."""
    if not LinkStore(parts.registry.database).revoke(jobs.get(job_id).id, link_id, caller.actor):
        raise Problem(404, "unknown_link", f"job {job_id} has no link {link_id[:40]!r}")


@router.head(SHARED + "{token}.nc", include_in_schema=False)
@router.get(SHARED + "{token}.nc", response_class=FileResponse,
            responses={**FILE, **NOT_MODIFIED, **problems(404, 416, 429, 503)})
def shared(token: Annotated[str, Path(max_length=100)], request: Request, parts: InParts) -> Response:
    """The dataset of a link, whole or by byte ranges, as `/v1/jobs/{id}/dataset` gives it; no key is asked for."""
    return whole(_job(token, parts), request, parts)


@router.get(SHARED + "{token}/zarr/{key:path}", response_class=Response, responses={**BYTES, **problems(404, 429, 503)})
def shared_zarr(token: Annotated[str, Path(max_length=100)], key: Annotated[str, Path(max_length=200)],
                parts: InParts) -> Response:
    """The same as `/v1/jobs/{id}/zarr` gives it: `xarray.open_zarr(address of /v1/shared/TOKEN/zarr)`."""
    return zarr_of(_job(token, parts), key, parts)


@router.get(SHARED + "{token}/opendap.{what}", response_class=Response,
            responses={**BYTES, **problems(404, 422, 429, 503)})
def shared_opendap(token: Annotated[str, Path(max_length=100)], what: Dap, request: Request,
                   parts: InParts) -> Response:
    """The same as `/v1/jobs/{id}/opendap` gives it, for whoever sends no key: ncdump, R and Octave."""
    return dap_of(_job(token, parts), what, request.url.query, parts)


def _job(token: str, parts: Parts) -> Job:
    """The job whose dataset a link opens. Raises Problem."""
    link = LinkStore(parts.registry.database).opened(token, time.time())
    if link is None:
        raise Problem(404, "link_not_good", "this link is not good: it is unknown, expired or revoked")
    grant = parts.rate.ask(f"link {link.id}")
    if grant.wait > 0:
        raise Problem(429, "too_many_requests", f"this link is used too often: wait {grant.wait:.2f} s",
                      {"Retry-After": str(ceil(grant.wait))})
    return parts.registry.get(link.job_id)


def _document(link: Link, address: str | None = None) -> LinkDocument:
    addresses = {name: None if address is None else address + end for name, end in ENDS.items()}
    return LinkDocument(id=link.id, **addresses, created=_instant(link.created), expires=_instant(link.expires),
                        revoked=None if link.revoked is None else _instant(link.revoked))


def _instant(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)
