"""A case, schema version 1: everything that a simulation needs to know, as its file or request says it."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from service.cases.ends import EndsSpec
from service.cases.errors import refusal
from service.cases.initial import InitialSpec
from service.cases.quantities import Positive, Spec
from service.cases.rod import RodSpec
from service.cases.size import MOST_NODE_FRAMES, refuse_large
from service.cases.surroundings import ContactSpec, FluidSpec, LoadsSpec
from service.meaning import FILE_NAME, NO_CONTROL, means
from solver import Numerics
from solver.measures.frame import OUTPUTS
from solver.methods.linear.registry import LINEAR_SOLVERS
from solver.run.first_mesh import with_nodes_at

ALL_FIELDS = tuple(output.name for output in OUTPUTS if output.along_rod)
if TYPE_CHECKING:
    FieldName = str
else:
    FieldName = Literal[ALL_FIELDS]

TOLERANCE, INTERVALS, DT_MAX = 1e-3, 200, 0.05
"""Where nothing is said about the resolution, the first; where something is, the others."""

NULLABLE = ("tolerance", "intervals", "dt_max", "increment_tolerance")
"""What numerics may say null to, as if it were not given."""

OF_THE_BOX = {"method", "linear_solver", "rho_inf", "rho_inf_space"}
"""What numerics say of no other method than the box method, or of which one it is."""

Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]

if TYPE_CHECKING:
    LinearSolver = str
else:
    LinearSolver = Literal[tuple(LINEAR_SOLVERS)]


class NumericsSpec(Spec):
    """How the equations are solved: see `solver.Numerics`. Either by `intervals` and `dt_max`, or to a `tolerance`."""

    method: Annotated[
        Literal["box", "staggered"],
        means("`box`: the paper's, generalized-alpha; `staggered`: rigid segments and Radau IIA of order 5, more "
              "accurate at long steps (`rho_inf` and `linear_solver` say nothing to it). With a tolerance, a rod that "
              "can stretch or resists its own bending, or a body at an end `staggered`, and no other"),
    ] = "box"  # fmt: skip
    linear_solver: Annotated[
        LinearSolver,
        means("`shooting`: the paper's, which loses its digits on thin rods at short steps"),
    ] = Numerics.linear_solver
    intervals: Annotated[
        Annotated[int, Field(ge=2, le=20_000)] | None,
        means(f"along the rod, instead of a tolerance; {INTERVALS} where another resolution is given. With `static` "
              "the fewest from there to half as many again that have a node at each point load"),
    ] = None
    dt_max: Annotated[
        Positive | None,
        means(f"the largest step, instead of a tolerance; {DT_MAX:g} where another resolution is given. Steps are "
              "shortened where the motion or Newton's iteration asks for it", "s"),
    ] = None  # fmt: skip
    rho_inf: Annotated[Fraction, means("numerical damping of fast motion: 1 is none, 0 the most")] = 0.5
    rho_inf_space: Annotated[
        Fraction,
        means("the same along s; 1 is the box scheme. Below 1 only for comparison: slower, needs long steps, and not "
              "with `shooting`"),
    ] = 1.0  # fmt: skip
    increment_tolerance: Annotated[
        Positive | None,
        means("largest error of a step relative to its motion; where none is given box 0.1, staggered 0.01"),
    ] = None
    tolerance: Annotated[
        Annotated[float, Field(ge=1e-6, le=0.1, allow_inf_nan=False)] | None,
        means("relative error of r, curvature and energies, and that of Tw and Wr in turns, at which refining "
              f"ends: a target. {TOLERANCE:g} where nothing else is given but `verify` and `method` `staggered`. Not "
              "beside `intervals`, `dt_max` or `increment_tolerance`"),
    ] = None  # fmt: skip
    verify: Annotated[
        bool,
        means("also runs with intervals and steps half as long: stores the extrapolated solution, and the estimated "
              "error of each variable. A tolerance does so by itself"),
    ] = False  # fmt: skip

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, raw: Any) -> Any:
        """Where nothing is said about the resolution or the box method, a tolerance; else all of the resolution."""
        if not isinstance(raw, dict):
            return raw
        values = _settings(raw)
        if _to_tolerance(raw):
            return {"method": "staggered", "tolerance": TOLERANCE, **values}
        return {"intervals": INTERVALS, "dt_max": DT_MAX, **values}

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.tolerance is not None:
            for name in ("intervals", "dt_max", "increment_tolerance"):
                if getattr(self, name) is not None:
                    rule = "must not be given beside a tolerance, which chooses it: leave out one of the two"
                    raise refusal(name, getattr(self, name), rule)
            if self.method != "staggered":
                raise refusal("method", self.method, "must be staggered with a tolerance")
        return self

    @property
    def expected_intervals(self) -> int:
        """The intervals, or those that a tolerance often leads to."""
        return self.intervals or INTERVALS

    @property
    def has_errors(self) -> bool:
        """Whether each variable comes with its estimated error."""
        return self.verify or self.tolerance is not None

    def build(self, frames: int) -> Numerics:
        """The solver's settings for a run of so many frames."""
        most = min(Numerics.most_intervals, MOST_NODE_FRAMES // frames)
        return Numerics(**{name: value for name, value in self if value is not None}, most_intervals=most)


def _settings(raw: dict[str, Any]) -> dict[str, Any]:
    """The numerics of a case, without those that are null."""
    return {name: value for name, value in raw.items() if value is not None or name not in NULLABLE}


def _to_tolerance(raw: dict[str, Any]) -> bool:
    """Whether numerics ask for a tolerance: where they say nothing about the resolution or the box method, too."""
    values = _settings(raw)
    return "tolerance" in values or (values.keys() <= {"method", "verify"} and values.get("method") != "box")


def _asking_for_staggered(rod: RodSpec, ends: EndsSpec) -> Iterator[tuple[str, str]]:
    """The fields that no other method knows, and what they describe."""
    for name, does in (("axial_stiffness", "can stretch"), ("retardation_time", "resists its own bending")):
        if getattr(rod, name) is not None:
            yield f"rod.{name}", f"a rod that {does}"
    for name in ("start", "end"):
        if getattr(getattr(ends, name), "mass", 0.0) > 0.0:
            yield f"ends.{name}.mass", "a body at an end"


class OutputSpec(Spec):
    """What is stored, and how often."""

    interval: Annotated[
        Positive,
        means("time between frames, the last of which is at `t_end`. Steps end exactly on frames; with a tolerance on "
              "every fifth at least, and the frames between lie on the steps' own polynomials", "s"),
    ]  # fmt: skip
    fields: Annotated[
        tuple[FieldName, ...], Field(min_length=1), means("which variables along the rod are stored")
    ] = ALL_FIELDS
    topology: Annotated[
        bool,
        means("whether writhe and linking number are computed, which takes a time that grows with the square of "
              "`intervals` where strands are near each other"),
    ] = True  # fmt: skip

    @model_validator(mode="after")
    def _check(self) -> Self:
        for i, name in enumerate(self.fields):
            if name in self.fields[:i]:
                raise refusal(f"fields/{i}", name, "must be named once only")
        return self


class CaseSpec(Spec):
    """One case. All quantities in SI units; s is the arclength from the start, t the time."""

    schema_version: Annotated[
        int, Field(ge=1, le=1), means("of these fields and their meaning")  # a Literal would take true for 1
    ]
    analysis: Annotated[Literal["dynamic", "static"], means("`static`: equilibria instead of motion")] = "dynamic"
    name: Annotated[
        str,
        Field(pattern=FILE_NAME, max_length=80),
        means("small letters, digits and hyphens, at most 80; names the output file"),
    ] = "unnamed"
    title: Annotated[str, Field(max_length=200, pattern=NO_CONTROL), means("for people: at most 200 characters")] = ""
    description: Annotated[str, Field(max_length=5000), means("for people: at most 5000 characters")] = ""
    rod: Annotated[RodSpec, means("length and section")]
    initial: Annotated[InitialSpec, means("shape and motion at t = 0")]
    ends: Annotated[EndsSpec, means("`start` at s = 0 and `end` at s = L")]
    fluid: Annotated[FluidSpec | None, means("water around the rod")] = None
    loads: Annotated[LoadsSpec, means("weight, given loads, damping")] = LoadsSpec()
    contact: Annotated[ContactSpec | None, means("self-contact; without it the rod passes through itself")] = None
    numerics: Annotated[
        NumericsSpec, means("how the equations are solved; to a tolerance, where nothing is said")
    ] = Field(default={}, validate_default=True)
    t_end: Annotated[Positive, means("how long to simulate", "s")]
    output: Annotated[OutputSpec, means("what is stored, and how often")]

    @property
    def frames(self) -> int:
        """How many frames the run yields, the one at t = 0 included."""
        return ceil(self.t_end / self.output.interval * (1 - 1e-12)) + 1

    def document(self) -> dict[str, Any]:
        """The case as plain JSON data, with every default filled in; `parse_case` gives it back."""
        return self.model_dump(mode="json", exclude_none=True)

    @field_validator("numerics", mode="before")
    @classmethod
    def _resolve(cls, raw: Any, case: ValidationInfo) -> Any:
        """What is not to a tolerance has the one method that knows its parts; in a static analysis the intervals have
        a node at each load."""
        if not isinstance(raw, dict) or _to_tolerance(raw):
            return raw
        rod, ends, loads = (case.data.get(part) for part in ("rod", "ends", "loads"))  # missing where they are refused
        if case.data.get("analysis") != "static":
            staggered = rod and ends and not raw.keys() & OF_THE_BOX and any(_asking_for_staggered(rod, ends))
            return {"method": "staggered", **raw} if staggered else raw
        places = [load.s / rod.length for load in loads.point] if rod and loads else []
        return {"intervals": with_nodes_at(places, INTERVALS), **raw}

    @model_validator(mode="after")
    def _check_positions(self) -> Self:
        for i, load in enumerate(self.loads.point):
            if load.s > self.rod.length:
                rule = f"must be <= the rod's length of {self.rod.length} m"
                raise refusal(f"loads/point/{i}/s", load.s, rule)
        return self

    @model_validator(mode="after")
    def _check_statics(self) -> Self:
        for name in ("velocity", "angular_velocity"):
            if self.analysis == "static" and any(velocity := getattr(self.initial, name)):
                raise refusal(f"initial/{name}", velocity, "must be 0 in a static analysis, in which nothing moves")
        return self

    @model_validator(mode="after")
    def _check_laws(self) -> Self:
        if self.analysis == "dynamic" and self.numerics.method == "box":
            for field, what in _asking_for_staggered(self.rod, self.ends):
                rule = f"must be staggered for {what}: leave out {field}, or give this method"
                raise refusal("numerics/method", self.numerics.method, rule)
        return self

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        refuse_large(self)
        return self
