"""The tables of guide.md, each from where the code defines what it tells."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from pydantic import TypeAdapter

from docs.fields import fields_table
from docs.markers import markdown
from outcomes import Outcome
from service.api.app import create_app
from service.cases import case_schema, cost, outlook
from service.results.schema import VARIABLES
from service.settings import Settings, variable

NAME = re.compile(r"\b[A-Za-z]\w*(?:[._]\w+)+\b")
"""What the code calls something, in a sentence that also stands where there is no markup."""


def variables() -> str:
    """The variables of a dataset, with the units and long names that stand in it."""
    rows = [(f"`{v.name}`", ", ".join(v.dimensions), v.units, v.long_name) for v in VARIABLES]
    return markdown(("variable", "dimensions", "unit", "meaning"), rows)


def outcomes() -> str:
    """How a run can end, and what to do about it."""
    rows = [(f"`{outcome.value}`", _marked(outcome.meaning), _marked(outcome.remedy), ", ".join(outcome.givers))
            for outcome in Outcome]  # fmt: skip
    return markdown(("outcome", "meaning", "remedy", "by the"), rows)


def calls() -> str:
    """The operations of the HTTP interface, as its OpenAPI document has them."""
    paths = _interface()["paths"]
    rows = [_call(method, path, operation)
            for path, operations in paths.items() for method, operation in operations.items()]  # fmt: skip
    return markdown(("call", "in the query", "status", "answer"), rows)


def _interface() -> dict[str, Any]:
    return create_app(Settings()).openapi()


def _call(method: str, path: str, operation: dict[str, Any]) -> tuple[str, ...]:
    query = [f"`{parameter['name']}`" for parameter in operation.get("parameters", ()) if parameter["in"] == "query"]
    good = [status for status in operation["responses"] if status < "4"]
    first = operation["description"].split("\n\n")[0].replace("\n", " ")
    return f"`{method.upper()} {path}`", ", ".join(query), ", ".join(good), first


def _at_rest() -> str:
    dearer = ", ".join(f"{times:g} {what}" for what, times in outlook.DEARER.items())
    return (f"{outlook.STATIC:g} (frames + {outlook.STATIC_START}) {outlook.STATIC_DOUBLED:g}^m, with a first mesh of "
            f"16 2^m intervals; so many times more: {dearer}")  # fmt: skip


def costs() -> str:
    """What the estimate of a case's cost counts."""
    def micro(rate: float) -> str:
        return f"{rate * 1e6:g}"

    more = f"frames / {outlook.FRAMES}"
    least, most = (extreme(outlook.SECONDS.items(), key=lambda item: item[1]) for extreme in (min, max))
    kinds = f"one of {len(outlook.SECONDS)} figures, from {least[1]:g} ({least[0]}) to {most[1]:g} ({most[0]})"
    rows = [
        ("a step", f"{micro(cost.STEP)} + {micro(cost.STEP_NODE)} nodes"),
        ("a step of a static analysis", f"{micro(cost.STATIC_NODE)} nodes, {cost.ON_SOLIDS} times on solids"),
        ("a step of a static analysis with contact", f"{micro(cost.STATIC_CONTACT_NODE)} nodes"),
        ("a step with contact, besides", f"{micro(cost.POINT)} points + {micro(cost.PAIR)} pairs within the cutoff"),
        ("a frame", f"{micro(cost.FRAME)} + {micro(cost.FRAME_NODE)} nodes"),
        ("a frame with `output.topology`, besides", f"{micro(cost.WRITHE)} nodes²"),
        ("steps with an `increment_tolerance` below the usual one", "(usual / given)^(1/2) times, `staggered` ^(1/4)"),
        ("all of it with a `tolerance` below 1e-3", "(1e-3 / given)^(1/2) times, up to 10 s"),
        ("and no less, by what sets the rod moving, than so many seconds", kinds),
        (f"these, with more than {outlook.FRAMES} frames",
         f"{more} times below {outlook.FOLLOWED:g} s, else ({more})^{outlook.BY_FRAMES:g} times, "
         f"up to {outlook.MOST:g} s"),
        ("a static analysis with a tolerance of 1e-3, in seconds", _at_rest()),
        ("all of it with `verify` and no tolerance", f"{cost.VERIFIED} times"),
    ]
    return markdown(("what", "CPU time, µs"), rows)


def settings() -> str:
    """The settings of the service."""
    return fields_table(TypeAdapter(Settings).json_schema(), label=variable).replace("| field |", "| variable |", 1)


def _marked(sentence: str) -> str:
    return NAME.sub(r"`\g<0>`", sentence)


def _part(*names: str) -> Callable[[], str]:
    """The fields of a part of a case, by the names of its models."""
    return lambda: fields_table(*(case_schema()["$defs"][name] for name in names))


TABLES: dict[str, Callable[[], str]] = {
    "case": lambda: fields_table(case_schema()),
    "rod": _part("RodSpec"),
    "initial": _part("Straight", "Centreline"),
    "end": _part("EndObject"),
    "fluid": _part("FluidSpec"),
    "shear": _part("ShearSpec"),
    "loads": _part("LoadsSpec"),
    "distributed load": _part("DistributedSpec"),
    "point load": _part("PointSpec"),
    "floor": _part("FloorSpec"),
    "obstacle": _part("ObstacleSpec"),
    "contact": _part("ContactSpec"),
    "numerics": _part("NumericsSpec"),
    "output": _part("OutputSpec"),
    "variables": variables,
    "outcomes": outcomes,
    "calls": calls,
    "request": lambda: fields_table(_interface()["components"]["schemas"]["JobRequest"]),
    "ensemble": lambda: fields_table(_interface()["components"]["schemas"]["EnsembleRequest"]),
    "parameter": lambda: fields_table(_interface()["components"]["schemas"]["ParameterRequest"]),
    "sample": lambda: fields_table(_interface()["components"]["schemas"]["SampleRequest"]),
    "costs": costs,
    "settings": settings,
}
