"""A parameter of a query comes once."""

from __future__ import annotations

from collections import Counter

from starlette.datastructures import QueryParams

from service.api.problems import Problem


def check_once(query: bytes) -> None:
    """Refuse a parameter that is repeated: all of its values but the last would be passed over. Raises Problem 422."""
    if b"&" not in query:
        return
    parameters = QueryParams(query)
    counts = Counter(name for name, _ in parameters.multi_items())
    rule = "must come once; several names have commas between them"
    if errors := [{"parameter": name, "value": parameters.getlist(name), "rule": rule}
                  for name, count in counts.items() if count > 1]:  # fmt: skip
        raise Problem(422, "invalid_parameters", f"{errors[0]['parameter']} {rule}", errors=errors)
