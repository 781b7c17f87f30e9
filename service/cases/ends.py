"""The ends of a case: six conditions each, by a preset's name or component by component.

A component is conditioned once: its rate, its position, or its load.

    translation  v1 v2 v3 (m/s)           x1 x2 x3 (displacement, m)        f1 f2 f3 (N)
    rotation     omega1 omega2 omega3 (rad/s)  theta1 theta2 theta3 (rad)   q1 q2 q3 (N m)
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from service.cases.errors import refusal
from service.cases.quantities import FrameName, Positive, Schedule, Spec, curve
from solver import Condition, End
from solver.scene.ends import Component

PresetName = Literal["clamp", "pin", "slider", "free"]
PRESETS = {"clamp": End.clamp, "pin": End.pin, "slider": End.slider, "free": End.free}

_KINDS: tuple[tuple[Literal["rate", "position", "load"], str, str], ...] = (
    ("rate", "v", "omega"),
    ("position", "x", "theta"),
    ("load", "f", "q"),
)


class _Conditions(Spec):
    """Conditions on some of the six components; the rates are told apart below, where they may be stops."""

    x1: Schedule | None = None
    x2: Schedule | None = None
    x3: Schedule | None = None
    f1: Schedule | None = None
    f2: Schedule | None = None
    f3: Schedule | None = None
    theta1: Schedule | None = None
    theta2: Schedule | None = None
    theta3: Schedule | None = None
    q1: Schedule | None = None
    q2: Schedule | None = None
    q3: Schedule | None = None

    @model_validator(mode="after")
    def _one_kind_a_component(self) -> Self:
        for rotation in (False, True):
            for i in range(3):
                given = [name for _, name in self._given(rotation, i)]
                if len(given) > 1:
                    rule = f"must not be given together with {given[0]}: one component, one kind"
                    raise refusal(given[1], None, rule)
        return self

    def _given(self, rotation: bool, i: int) -> list[tuple[Literal["rate", "position", "load"], str]]:
        """Kind and name of each condition on one component (there should be one at most)."""
        names = [(kind, f"{turn if rotation else shift}{i + 1}") for kind, shift, turn in _KINDS]
        return [(kind, name) for kind, name in names if getattr(self, name) is not None]

    def condition(self, rotation: bool, i: int, since: float = 0.0) -> Condition | None:
        """The condition on component `i` (0, 1, 2) from `since` (s) on, None where none is given."""
        for kind, name in self._given(rotation, i):
            given = getattr(self, name)
            if isinstance(given, Stop):
                return Condition("stop", since=since, within=given.stop_within)
            return Condition(kind, curve(given), since)
        return None


class Stop(Spec):
    """Bring the component's rate smoothly to zero within `stop_within` (s) and hold it there."""

    stop_within: Positive


def _rate_or_stop(value: Any) -> str:
    stops = isinstance(value, Stop) or (isinstance(value, dict) and "stop_within" in value)
    return "<stop>" if stops else "<rate>"


Rate = Annotated[
    Annotated[Schedule, Tag("<rate>")] | Annotated[Stop, Tag("<stop>")], Discriminator(_rate_or_stop)
]


class Switch(_Conditions):
    """New conditions on some components from the time `at` (s) on; a rate may be a stop."""

    at: Positive
    v1: Rate | None = None
    v2: Rate | None = None
    v3: Rate | None = None
    omega1: Rate | None = None
    omega2: Rate | None = None
    omega3: Rate | None = None

    @model_validator(mode="after")
    def _not_empty(self) -> Self:
        if self.model_fields_set == {"at"}:
            raise refusal("", None, "must change at least one component")
        return self


class EndObject(_Conditions):
    """An end: a preset, what differs from it, and switches at later times.

    `frame`: axes of the translation's components, a1 a2 a3 ("material") or e1 e2 e3 ("lab"); those of
    the rotation are always material. Without a preset all six components must be given.
    """

    preset: PresetName | None = None
    frame: FrameName = "material"
    v1: Schedule | None = None
    v2: Schedule | None = None
    v3: Schedule | None = None
    omega1: Schedule | None = None
    omega2: Schedule | None = None
    omega3: Schedule | None = None
    switches: Annotated[tuple[Switch, ...], Field(max_length=100)] = ()

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
            names = ", ".join(f"{turn if rotation else shift}{i + 1}" for _, shift, turn in _KINDS)
            raise refusal("", None, f"needs a preset, or one of {names}")

    def build(self) -> End:
        """The solver's end."""
        preset = PRESETS[self.preset or "free"]()
        first, second, third = (self._component(False, i, preset.translation[i]) for i in range(3))
        fourth, fifth, sixth = (self._component(True, i, preset.rotation[i]) for i in range(3))
        return End((first, second, third), (fourth, fifth, sixth), self.frame)

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

    start: EndSpec
    end: EndSpec


def build_end(given: PresetName | EndObject) -> End:
    """The solver's end of a preset's name or of an end written out."""
    return PRESETS[given]() if isinstance(given, str) else given.build()
