"""/v1/ensembles/{id}/scalars, /data, /sensitivity: the numbers of all members at once, beside their parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from service.api.data import part_of
from service.api.description import problems
from service.api.ensembles import VisibleEnsembles, ensemble_of
from service.api.formats import CONTENT, Accept, Variables, VariablesInRanges, format_of, readable, response_of
from service.api.parts import InParts, Jobs, Parts
from service.api.problems import Problem
from service.api.scalars import job_columns, values_of
from service.cases.sampling import sobol_indices
from service.jobs import Registry, Status
from service.jobs.ensembles import Ensemble, Member
from service.jobs.registry import DeletedJob
from service.results import subset
from service.results.combined import ALONG, combined
from service.results.part import Column, Part
from service.results.query import Source
from service.results.scalars import Value, scalar_columns, scalar_variables

NOTHING = ("not_finished", "no_dataset", "dataset_lost")
router = APIRouter(prefix="/v1/ensembles/{ensemble_id}", tags=["ensembles"])


class MemberScalars(BaseModel):
    """A member's parameters, and the last values of its variables; null where it has none (yet)."""

    number: int
    job: str
    status: Status
    outcome: str
    t: float
    parameters: dict[str, Any]
    values: dict[str, Value]


class EnsembleScalars(BaseModel):
    """A record of each member, in their order."""

    members: list[MemberScalars]


class SobolIndex(BaseModel):
    """A parameter's part of the variance of a variable: `first` by itself, `total` with all that it does together with
    others; each with the half width of its 95 % confidence interval."""

    first: float
    first_confidence: float
    total: float
    total_confidence: float


class Sensitivity(BaseModel):
    """Sobol's indices by variable and parameter."""

    indices: dict[str, dict[str, SobolIndex]]


class Names(BaseModel):
    """Of which variables."""

    model_config = ConfigDict(extra="forbid")
    variables: str = Field(min_length=1, max_length=1000, examples=["Tw,Wr"])


@router.get("/scalars", response_model=EnsembleScalars, responses={**CONTENT, **problems(404, 422, 503)})
def ensemble_scalars(ensemble_id: str, query: Annotated[Variables, Query()], parts: InParts, jobs: Jobs,
                     ensembles: VisibleEnsembles, accept: Accept = None) -> Response:
    """Variables that have no place along the rod, at the end of each member, beside its parameters; but for JSON a
    table, a row for each member, or as NetCDF with the parameters as coordinates."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    with readable():
        names = scalar_variables(query.names)
    members = ensembles.members(ensemble.id)
    values = values_of([member.job for member in members], names, jobs, parts)
    name, form = format_of(query.format, accept)
    if name != "json":
        facts = job_columns([member.job for member in members], ALONG)
        coordinates = (*parameter_columns(ensemble, members), *facts)
        return response_of(Part(coordinates, scalar_columns(names, values, ALONG)), form)
    records = [
        MemberScalars(number=member.number, job=member.job.id, status=member.job.status, outcome=member.job.outcome,
                      t=member.job.t, parameters=dict(zip(ensemble.names, member.values, strict=True)), values=scalars)
        for member, scalars in zip(members, values, strict=True)
    ]  # fmt: skip
    return Response(EnsembleScalars(members=records).model_dump_json(), media_type=form.media_type)


@router.get("/data", response_class=Response, responses={**CONTENT, **problems(404, 409, 422, 503)})
def ensemble_data(ensemble_id: str, query: Annotated[VariablesInRanges, Query()], parts: InParts, jobs: Jobs,
                  ensembles: VisibleEnsembles, accept: Accept = None) -> Response:
    """Variables of all members as one dataset, with the dimension `member` and the parameters as its coordinates. Of
    members that run the frames so far; NaN where one has no such time or node, or nothing yet."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    members = ensembles.members(ensemble.id)
    _, form = format_of(query.format, accept)
    read = _Reader(query, form.limit, parts, jobs)
    own = parameter_columns(ensemble, members)
    with readable():
        member_parts = [read(member) for member in members]
        if not any(member_parts):
            raise Problem(409, "not_finished", f"of the members of ensemble {ensemble.id} none has frames (yet): "
                          "see its status", {"Retry-After": "1"})  # fmt: skip
        return response_of(combined(member_parts, own, form.limit, form.table), form)


@router.get("/sensitivity", responses=problems(404, 409, 422, 503))
def ensemble_sensitivity(ensemble_id: str, query: Annotated[Names, Query()], parts: InParts, jobs: Jobs,
                         ensembles: VisibleEnsembles) -> Sensitivity:
    """Sobol's indices of the last values of some variables, of an ensemble whose sample is `saltelli`."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    if ensemble.design["method"] != "saltelli":
        raise Problem(422, "no_saltelli_sample", "Sobol's indices need an ensemble whose sample has the method "
                      f"saltelli, this one has {ensemble.design['method']}")
    with readable():
        names = scalar_variables([name.strip() for name in query.variables.split(",")])
    members = ensembles.members(ensemble.id)
    columns = scalar_columns(names, values_of([member.job for member in members], names, jobs, parts), ALONG)
    return Sensitivity(indices={column.name: _indices(ensemble, members, column) for column in columns})


class _Reader:
    """Reads a part of each member, equal ones once, and no more than may be given out."""

    def __init__(self, query: VariablesInRanges, limit: int, parts: Parts, jobs: Registry) -> None:
        self._query, self._left, self._parts, self._jobs = query, limit, parts, jobs
        self._read: dict[str, Part | None] = {}

    def __call__(self, member: Member) -> Part | None:
        """A member's part; None where it has nothing. Raises Problem, SubsetTooLarge."""
        if member.job.id not in self._read:
            self._read[member.job.id] = self._part(member.job.id)
        return self._read[member.job.id]

    def _part(self, job_id: str) -> Part | None:
        def read(source: Source) -> Part:
            return subset(source, self._query.names, self._query.ranges, self._left)

        try:
            _, part = part_of(job_id, self._jobs, self._parts, read)
        except DeletedJob:
            return None
        except Problem as problem:
            if problem.name in NOTHING:
                return None
            raise
        self._left -= sum(column.values.size for column in part.variables)
        return part


def parameter_columns(ensemble: Ensemble, members: Sequence[Member]) -> tuple[Column, ...]:
    """The members' numbers and parameters."""
    number = Column(ALONG, (ALONG,), np.array([member.number for member in members]))
    columns = [_parameter(name, ensemble, [member.values[i] for member in members])
               for i, name in enumerate(ensemble.names)]  # fmt: skip
    return (number, *columns)


def _parameter(name: str, ensemble: Ensemble, values: list[Any]) -> Column:
    numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)
    array = np.array(values, float) if numbers else np.array([str(value) for value in values])
    return Column(name, (ALONG,), array, {"long_name": ensemble.design["parameters"][name]["path"]})


def _indices(ensemble: Ensemble, members: Sequence[Member], column: Column) -> dict[str, SobolIndex]:
    if column.values.ndim != 1 or not np.isfinite(column.values).all():
        waiting = sum(member.job.dataset is None for member in members)
        raise Problem(409, "values_missing", f"each member must have a number for {column.name}: {waiting} have no "
                      "dataset (yet), see the status of the ensemble", {"Retry-After": "5"})
    indices = sobol_indices(column.values, len(ensemble.names))
    return {name: SobolIndex(**vars(index)) for name, index in zip(ensemble.names, indices, strict=True)}
