"""What a request for an ensemble holds: a case, and which of its values the members have instead."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from service.api.requests import SHIPPED, CaseOrName, LimitsRequest
from service.cases import CaseError, CaseSpec, FieldError, apply_settings, load_case, parse_case
from service.cases.errors import refusal
from service.cases.sampling import Method, Range, Values, grid, sample, size_of
from service.cases.suggestions import suggested
from service.meaning import NO_CONTROL, means
from service.results.schema import ERRORS, LABELS, VARIABLES

MOST_MEMBERS = 10_000
MOST_PARAMETERS = 50
MOST_BYTES = 100_000_000
"""Of the cases of all members."""
NAME = r"[A-Za-z][A-Za-z0-9_.-]{0,99}"
RESERVED = frozenset({"member", "time", "s", "id", "job", "label", "status", "outcome", "t", *LABELS,
                   *(variable.name for variable in (*VARIABLES, *ERRORS.values()))})
"""What else stands beside the parameters in a table or a dataset."""
LATE = ("t_end", "ends", "loads.point", "loads.distributed", "output.fields")
"""Where a case holds what comes later."""
Number = Annotated[float, Field(allow_inf_nan=False)]


def _values_alone(raw: Any) -> Any:
    return {"values": raw} if isinstance(raw, list) else raw


class ParameterRequest(BaseModel):
    """A value of the case that differs from member to member: listed, or in a range that is sampled."""

    model_config = ConfigDict(extra="forbid", strict=True)
    path: Annotated[
        Annotated[str, Field(min_length=1, max_length=200)] | None,
        means("its dotted key in the case; the parameter's name where none is given"),
    ] = None
    values: Annotated[
        Annotated[list[Any], Field(min_length=1, max_length=MOST_MEMBERS)] | None, means("of a grid")
    ] = None
    low: Annotated[Number | None, means("where the range of a sample begins")] = None
    high: Annotated[Number | None, means("where it ends")] = None
    scale: Annotated[Literal["linear", "log"], means("how a sample fills its range")] = "linear"

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.low is None) != (self.high is None):
            raise refusal("low" if self.low is None else "high", None, "is required: a range has both ends")
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise refusal("high", self.high, f"must be > low, which is {self.low}")
        if self.scale == "log" and self.low is not None and self.low <= 0.0:
            raise refusal("low", self.low, "must be > 0 with the scale log")
        return self

    @property
    def range(self) -> Range:
        """The range of a sample."""
        return Range(self.low or 0.0, self.high or 0.0, self.scale == "log")


Parameter = Annotated[ParameterRequest, BeforeValidator(_values_alone)]


class SampleRequest(BaseModel):
    """How ranges are sampled."""

    model_config = ConfigDict(extra="forbid", strict=True)
    method: Annotated[
        Method,
        means("`latin_hypercube`, `sobol`, or `saltelli`: size (parameters + 2) members, from which `/sensitivity` "
              "estimates Sobol's indices"),
    ]  # fmt: skip
    size: Annotated[int, Field(ge=1, le=MOST_MEMBERS), means("how many points; a power of two but for a hypercube")]
    seed: Annotated[int, Field(ge=0, lt=2**32), means("the same seed gives the same values")] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.method != "latin_hypercube" and self.size & (self.size - 1):
            raise refusal("size", self.size, f"must be a power of two with the method {self.method}")
        return self


class EnsembleRequest(BaseModel):
    """A case, the values that its members have instead, and what belongs to their jobs."""

    model_config = ConfigDict(extra="forbid", strict=True)
    case: Annotated[CaseOrName, means("a whole case, or the name of a shipped one")]
    set: Annotated[dict[str, Any], means("values to change in it for all members, by dotted key")] = {}
    parameters: Annotated[
        dict[str, Parameter], Field(max_length=MOST_PARAMETERS),
        means("what differs, by a name of yours: the `values` of a grid (a list alone is one), or the ends of a range "
              "that is sampled"),
    ] = {}  # fmt: skip
    sample: Annotated[SampleRequest | None, means("fills the ranges, instead of a grid")] = None
    members: Annotated[
        Annotated[list[dict[str, Any]], Field(min_length=1, max_length=MOST_MEMBERS)] | None,
        means("the values of each member by name, instead of a grid"),
    ] = None
    title: Annotated[str, Field(max_length=200, pattern=NO_CONTROL), means("for people")] = ""
    label: Annotated[str, Field(max_length=100, pattern=NO_CONTROL), means("of each of its jobs")] = ""
    priority: Annotated[int, Field(ge=-100, le=100), means("of each of its jobs")] = 0
    reuse: Annotated[
        bool, means("jobs of yours that have run the same cases are members instead of new ones")
    ] = True
    limits: Annotated[LimitsRequest, means("of each of its jobs")] = LimitsRequest()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.members is not None:
            self._check_list(self.members)
        elif not self.parameters:
            raise refusal("parameters", None, "is required, or members: what differs from member to member")
        for name in self.names:
            if not re.fullmatch(NAME, name):
                raise refusal(self._where, name, "must be names of letters, digits, '.', '_' and '-', a letter first")
            if name in RESERVED:
                raise refusal(self._where, name, "must not be named as what a dataset or a table has besides")
        for name, parameter in self.parameters.items():
            self._check_parameter(name, parameter)
        self._check_paths()
        if self.many > MOST_MEMBERS:
            raise refusal("parameters", None, f"must give at most {MOST_MEMBERS:,} members, not {self.many:,}")
        return self

    def _check_list(self, members: list[dict[str, Any]]) -> None:
        if self.sample is not None:
            raise refusal("sample", None, "must not be given beside members: they have their values")
        for i, member in enumerate(members):
            if member.keys() != members[0].keys() or not member:
                raise refusal(f"members/{i}", sorted(member), f"must name what the first one does: {[*members[0]]}")
        for name in self.parameters.keys() - members[0].keys():
            raise refusal(f"parameters/{name}", None, "must be named by each of members")

    def _check_parameter(self, name: str, parameter: ParameterRequest) -> None:
        if self.members is not None:
            required = ""
        else:
            required = "values" if self.sample is None else "low"
        for field in ("values", "low"):
            if getattr(parameter, field) is not None and field != required:
                rule = "must not be given beside members" if not required else (
                    "must not be given with a sample: it fills low to high" if field == "values"
                    else "needs a sample, which says how the range is filled")  # fmt: skip
                raise refusal(f"parameters/{name}/{field}", None, rule)
        if required and getattr(parameter, required) is None:
            rule = "is required for a grid" if required == "values" else "is required for a sample, and high"
            raise refusal(f"parameters/{name}/{required}", None, rule)

    def _check_paths(self) -> None:
        """What one parameter sets, none that comes after it may set once more: its values would not be those run."""
        within: dict[str, str] = {}
        for name, path in zip(self.names, self.paths, strict=True):
            if path in within:
                raise refusal(self._where, path, f"must not be set once more: {within[path]} is set in it")
            keys = path.split(".")
            within |= {".".join(keys[:depth]): name for depth in range(1, len(keys) + 1)}

    @property
    def _where(self) -> str:
        return "parameters" if self.members is None else "members"

    @property
    def many(self) -> int:
        """How many members there are."""
        if self.members is not None:
            return len(self.members)
        if self.sample is not None:
            return size_of(self.sample.method, self.sample.size, len(self.parameters))
        many = 1
        for parameter in self.parameters.values():
            many *= len(parameter.values or ())
        return many

    @property
    def names(self) -> list[str]:
        """Those of the parameters, in order."""
        return list(self.parameters if self.members is None else self.members[0])

    @property
    def paths(self) -> list[str]:
        """The dotted keys of the parameters, in order."""
        paths = {name: parameter.path for name, parameter in self.parameters.items()}
        return [paths.get(name) or name for name in self.names]

    @property
    def design(self) -> dict[str, Any]:
        """How the values were chosen."""
        parameters = {name: {"path": path} for name, path in zip(self.names, self.paths, strict=True)}
        if self.sample is not None:
            for name, parameter in self.parameters.items():
                parameters[name] |= parameter.model_dump(include={"low", "high", "scale"})
            return {**self.sample.model_dump(), "parameters": parameters}
        return {"method": "grid" if self.members is None else "list", "parameters": parameters}

    def values(self) -> list[Values]:
        """Those of each member, in the order of the parameters."""
        if self.members is not None:
            return [tuple(member[name] for name in self.names) for member in self.members]
        if self.sample is not None:
            ranges = [parameter.range for parameter in self.parameters.values()]
            return sample(self.sample.method, ranges, self.sample.size, self.sample.seed)
        return grid([parameter.values or [] for parameter in self.parameters.values()])

    @property
    def differs_late(self) -> bool:
        """Whether some members may begin as others do."""
        return any(path.startswith(LATE) for path in self.paths)

    def specs(self, values: list[Values]) -> Iterator[CaseSpec]:
        """The case of each member. Raises CaseError, which names the first member that cannot be run."""
        base = self._base()
        if (size := self._size(base)) > MOST_BYTES:
            raise CaseError([FieldError(f"/{self._where}", None, f"must make cases of at most {MOST_BYTES:,} bytes in "
                                        f"all, not {size:,} ({self.many:,} members)")])  # fmt: skip
        for number, own in enumerate(values):
            settings = dict(zip(self.paths, own, strict=True))
            try:
                yield parse_case(apply_settings(base, {**self.set, **settings}))
            except CaseError as error:
                of = ", ".join(f"{name} = {value!r}" for name, value in zip(self.names, own, strict=True))
                faults = [FieldError(f"/{self._where}", fault.value,
                                     f"member {number} ({of}): {fault.pointer or 'the case'} {fault.rule}")
                          for fault in error.errors]  # fmt: skip
                raise CaseError(faults, error.more) from None

    def _size(self, base: dict[str, Any]) -> int:
        """Bytes of the members' cases, about."""
        listed = [parameter.values for parameter in self.parameters.values() if parameter.values]
        own = sum(self.many // len(values) * len(json.dumps(values)) for values in listed)
        return self.many * len(json.dumps([base, self.set])) + own + len(json.dumps(self.members or ()))

    def _base(self) -> dict[str, Any]:
        if not isinstance(self.case, str):
            return self.case
        if self.case not in SHIPPED:  # a name only: never a path
            raise CaseError([FieldError("/case", self.case, f"must be one of {', '.join(SHIPPED)}")])
        return load_case(self.case)


def ensemble_request(body: dict[str, Any]) -> EnsembleRequest:
    """What a body asks for. Raises CaseError."""
    try:
        return EnsembleRequest.model_validate(body)
    except ValidationError as error:
        raise suggested(CaseError.of(error), EnsembleRequest) from None
