"""The ends of a case: six conditions each, by a preset's name or component by component.

A component is conditioned once: its rate, its position, or its load.

    translation  v1 v2 v3 (m/s)           x1 x2 x3 (displacement, m)        f1 f2 f3 (N)
    rotation     omega1 omega2 omega3 (rad/s)  theta1 theta2 theta3 (rad)   q1 q2 q3 (N m)
"""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from service.cases.errors import refusal
from service.cases.quantities import FrameName, NotNegative, Positive, Schedule, Spec, curve
from service.meaning import means
from solver import Condition, End
from solver.scene.ends import Component

PresetName = Literal["clamp", "pin", "slider", "free"]
PRESETS = {"clamp": End.clamp, "pin": End.pin, "slider": End.slider, "free": End.free}

_KINDS: tuple[tuple[Literal["rate", "position", "load"], str, str], ...] = (
    ("rate", "v", "omega"),
    ("position", "x", "theta"),
    ("load", "f", "q"),
)
_NAMES = {(rotation, i): [(kind, f"{turn if rotation else shift}{i + 1}") for kind, shift, turn in _KINDS]
          for rotation in (False, True) for i in range(3)}  # fmt: skip
"""Kind and name of the conditions that each component may have."""


Displacement = Annotated[
    Schedule | None,
    means("position: displacement along the axis since t = 0 or the switch; it is followed by its change", "m"),
]
Turn = Annotated[
    Schedule | None,
    means("position: rotation about the axis since t = 0 or the switch; it is followed by its change", "rad"),
]
Force = Annotated[Schedule | None, means("load: internal force", "N")]
Moment = Annotated[Schedule | None, means("load: internal moment", "N m")]
Velocity = Annotated[Schedule | None, means("rate: velocity along the axis", "m/s")]
AngularVelocity = Annotated[Schedule | None, means("rate: angular velocity about the axis", "rad/s")]


class _Conditions(Spec):
    """Conditions on some of the six components; the rates are told apart below, where they may be stops."""

    x1: Displacement = None
    x2: Displacement = None
    x3: Displacement = None
    f1: Force = None
    f2: Force = None
    f3: Force = None
    theta1: Turn = None
    theta2: Turn = None
    theta3: Turn = None
    q1: Moment = None
    q2: Moment = None
    q3: Moment = None

    @model_validator(mode="after")
    def _one_kind_a_component(self) -> Self:
        for rotation in (False, True):
            for i in range(3):
                present = [name for _, name in self._present(rotation, i)]
                if len(present) > 1:
                    rule = f"must not be given together with {present[0]}: one component, one kind"
                    raise refusal(present[1], None, rule)
        return self

    def _present(self, rotation: bool, i: int) -> list[tuple[Literal["rate", "position", "load"], str]]:
        """Kind and name of each condition on one component (there should be one at most)."""
        return [(kind, name) for kind, name in _NAMES[rotation, i] if getattr(self, name) is not None]

    def condition(self, rotation: bool, i: int, since: float = 0.0) -> Condition | None:
        """The condition on component `i` (0, 1, 2) from `since` (s) on, None where none is given."""
        for kind, name in self._present(rotation, i):
            value = getattr(self, name)
            if isinstance(value, Stop):
                return Condition("stop", since=since, within=value.stop_within)
            return Condition(kind, curve(value), since)
        return None


class Stop(Spec):
    """Bring the component's rate smoothly to zero and hold it there."""

    stop_within: Annotated[Positive, means("how long it takes", "s")]


def _rate_or_stop(value: Any) -> str:
    stops = isinstance(value, Stop) or (isinstance(value, dict) and "stop_within" in value)
    return "<stop>" if stops else "<rate>"


Rate = Annotated[
    Annotated[Schedule, Tag("<rate>")] | Annotated[Stop, Tag("<stop>")], Discriminator(_rate_or_stop)
]


SwitchedVelocity = Annotated[Rate | None, means("rate: velocity along the axis, or a stop", "m/s")]
SwitchedAngularVelocity = Annotated[Rate | None, means("rate: angular velocity about the axis, or a stop", "rad/s")]


class Switch(_Conditions):
    """New conditions from a time on: a preset, and what differs from it; a rate may be a stop."""

    at: Annotated[Positive, means("the time from which on the new conditions hold", "s")]
    preset: Annotated[
        PresetName | None, means("what holds from then on for components that are not named: `free` lets the end go")
    ] = None
    v1: SwitchedVelocity = None
    v2: SwitchedVelocity = None
    v3: SwitchedVelocity = None
    omega1: SwitchedAngularVelocity = None
    omega2: SwitchedAngularVelocity = None
    omega3: SwitchedAngularVelocity = None

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if self.preset is None and all(self.condition(rotation, i) is None for rotation, i in _NAMES):
            raise refusal("", None, "must change at least one component")
        return self

    def condition(self, rotation: bool, i: int, since: float = 0.0) -> Condition | None:
        """That of the component, or of the preset, from `since` (s) on; None where neither is given."""
        own = super().condition(rotation, i, since)
        if own is None and self.preset is not None:
            preset = PRESETS[self.preset]()
            own = replace((preset.rotation if rotation else preset.translation)[i][0], since=since)
        return own


class EndObject(_Conditions):
    """An end: a preset, what differs from it, and switches at later times."""

    preset: Annotated[
        PresetName | None, means("what holds for components that are not named; without it all six must be")
    ] = None
    frame: Annotated[
        FrameName, means("axes of the translation: a1, a2, a3 or e1, e2, e3; rotation is always material")
    ] = "material"
    v1: Velocity = None
    v2: Velocity = None
    v3: Velocity = None
    omega1: AngularVelocity = None
    omega2: AngularVelocity = None
    omega3: AngularVelocity = None
    mass: Annotated[
        NotNegative,
        means("m of a body at the end, a point: where it is loaded it pulls with m (g − dv/dt) besides. For "
              "`staggered` and static analyses", "kg"),
    ] = 0.0  # fmt: skip
    switches: Annotated[
        tuple[Switch, ...], Field(max_length=100), means("new conditions from later times on, in order")
    ] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        for i in range(1, len(self.switches)):
            if self.switches[i].at <= self.switches[i - 1].at:
                rule = f"must be later than the switch before it ({self.switches[i - 1].at} s)"
                raise refusal(f"switches/{i}/at", self.switches[i].at, rule)
        if self.preset is None:
            for rotation in (False, True):
                for i in range(3):
                    self._require(rotation, i)
        return self

    def _require(self, rotation: bool, i: int) -> None:
        if self.condition(rotation, i) is None:
            names = ", ".join(name for _, name in _NAMES[rotation, i])
            raise refusal("", None, f"needs a preset, or one of {names}")

    def build(self) -> End:
        """The solver's end."""
        preset = PRESETS[self.preset or "free"]()
        first, second, third = (self._component(False, i, preset.translation[i]) for i in range(3))
        fourth, fifth, sixth = (self._component(True, i, preset.rotation[i]) for i in range(3))
        return End((first, second, third), (fourth, fifth, sixth), self.frame, self.mass)

    def _component(self, rotation: bool, i: int, preset: Component) -> Component:
        own = self.condition(rotation, i)
        later = [switch.condition(rotation, i, switch.at) for switch in self.switches]
        return (own or preset[0], *(condition for condition in later if condition is not None))


def _name_or_object(value: Any) -> str:
    return "<preset>" if isinstance(value, str) else "<end>"


EndSpec = Annotated[
    Annotated[PresetName, Tag("<preset>")] | Annotated[EndObject, Tag("<end>")],
    Discriminator(_name_or_object),
]


class EndsSpec(Spec):
    """The two ends: `start` at s = 0 and `end` at s = L."""

    start: Annotated[EndSpec, means("at s = 0: `clamp`, `pin`, `slider`, `free`, or an object with what holds")]
    end: Annotated[EndSpec, means("at s = L, likewise")]


def build_end(end: PresetName | EndObject) -> End:
    """The solver's end of a preset's name or of an end written out."""
    return PRESETS[end]() if isinstance(end, str) else end.build()
