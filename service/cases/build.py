"""From a case to the solver's plain data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from service.cases.case import CaseSpec
from service.cases.ends import build_end
from service.cases.errors import CaseError, FieldError
from solver import Curve, Initial, Rod, Scene
from solver.initial import nodes_at_rest

Part = TypeVar("Part")


def build_scene(spec: CaseSpec) -> Scene:
    """The scene that the case describes.

    Raises CaseError with the part's pointer where the parts do not fit each other, for example a
    centreline that is not as long as the rod.
    """
    rod = _part("/rod", spec.rod.build)
    initial = _part("/initial", lambda: spec.initial.build(spec.rod.length))
    s = np.linspace(0.0, spec.rod.length, spec.numerics.intervals + 1)
    _part("/initial", lambda: nodes_at_rest(initial, s[:2]))  # refuses an a1 along the tangent
    if spec.rod.kappa0 == "initial":
        _, _, kappa = nodes_at_rest(initial, s)
        bend1, bend2, twist = (Curve.table(s, column, "cubic") for column in kappa.T)
        rod = replace(rod, kappa0=(bend1, bend2, twist))
    return _part("", lambda: _scene(spec, rod, initial))


def _scene(spec: CaseSpec, rod: Rod, initial: Initial) -> Scene:
    return Scene(
        rod=rod,
        initial=initial,
        start=build_end(spec.ends.start),
        end=build_end(spec.ends.end),
        t_end=spec.t_end,
        output_interval=spec.output.interval,
        gravity=spec.loads.gravity,
        distributed=tuple(load.build() for load in spec.loads.distributed),
        points=tuple(load.build() for load in spec.loads.point),
        damping=spec.loads.damping,
        fluid=spec.fluid.build() if spec.fluid else None,
        contact=spec.contact.build() if spec.contact else None,
        numerics=spec.numerics.build(),
        topology=spec.output.topology,
    )


def _part(pointer: str, build: Callable[[], Part]) -> Part:
    try:
        return build()
    except ValueError as error:
        raise CaseError([FieldError(pointer, None, f"cannot be built: {error}")]) from error
