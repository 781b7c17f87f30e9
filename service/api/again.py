"""A job's case once more, with a change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from service.api.requests import JobRequest
from service.cases import CaseError, CaseSpec, FieldError, parse_case
from service.cases.beginning import common_frame
from service.cases.suggestions import suggested
from service.jobs import Registry


@dataclass(frozen=True)
class Again:
    """A body that names a job, as one that has its case; and what the two runs have in common."""

    body: dict[str, Any]
    job_id: str
    case: dict[str, Any]

    @classmethod
    def of(cls, body: dict[str, Any], jobs: Registry) -> Again:
        """Raises CaseError, UnknownJob, DeletedJob."""
        try:
            asked = JobRequest.model_validate(body)
        except ValidationError as error:
            raise suggested(CaseError.of(error), JobRequest) from None
        if asked.job is None or asked.case is not None:
            raise CaseError([FieldError("/job", asked.job, "must name a job, and stand instead of case")])
        case = jobs.case(jobs.get(asked.job).id)
        told = {**body, "case": case if asked.fork is None else asked.fork.applied(case)}
        return cls({name: value for name, value in told.items() if name not in ("job", "fork")}, asked.job, case)

    def beginning(self, spec: CaseSpec) -> dict[str, Any]:
        """What a new job is told of it."""
        try:
            frame = common_frame(parse_case(self.case), spec)
        except CaseError:  # of an older version, to which it was one
            frame = 0
        return {"begins_with": self.job_id, "begins_at": frame} if frame else {}
