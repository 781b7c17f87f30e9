"""A job's case once more, with a change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from service.api.requests import JobRequest
from service.cases import CaseError, CaseSpec, FieldError, parse_case
from service.cases.beginning import common_frame, hindrance
from service.cases.suggestions import suggested
from service.jobs import Registry

FROM_ITS_START = "computed from its start: "


@dataclass(frozen=True)
class Again:
    """A body that names a job, as one that has its case; and what the two runs have in common."""

    body: dict[str, Any]
    job_id: str
    case: dict[str, Any]
    forked_at: float | None

    @classmethod
    def of(cls, body: dict[str, Any], jobs: Registry) -> Again:
        """Raises CaseError, UnknownJob, DeletedJob."""
        try:
            request = JobRequest.model_validate(body)
        except ValidationError as error:
            raise suggested(CaseError.of(error), JobRequest) from None
        if request.job is None or request.case is not None:
            raise CaseError([FieldError("/job", request.job, "must name a job, and stand instead of case")])
        case = jobs.case(jobs.get(request.job).id)
        merged = {**body, "case": case if request.fork is None else request.fork.applied(case)}
        return cls({name: value for name, value in merged.items() if name not in ("job", "fork")}, request.job, case,
                   None if request.fork is None else request.fork.at)

    def check(self, spec: CaseSpec) -> None:
        """Raises CaseError for a fork that comes after the end."""
        at = self.forked_at
        if at is not None and at >= spec.t_end:
            raise CaseError([FieldError("/fork/at", at, f"must be < t_end, which is {spec.t_end:g}")])

    def beginning(self, spec: CaseSpec) -> dict[str, Any]:
        """What a new job is told of it: where it begins, or why it is computed from its start."""
        try:
            first = parse_case(self.case)
        except CaseError:  # of an older version, to which it was one
            return {"message": FROM_ITS_START + "the other's case is one no more"}
        if frame := common_frame(first, spec):
            return {"begins_with": self.job_id, "begins_at": frame}
        return {"message": FROM_ITS_START + (hindrance(first, spec) or "no two frames of the cases are alike")}
