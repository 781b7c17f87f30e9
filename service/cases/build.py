"""From a case to the solver's plain data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import TypeVar

import numpy as np

from service.cases.case import CaseSpec
from service.cases.ends import build_end
from service.cases.errors import CaseError, FieldError
from service.cases.initial import InitialSpec
from service.cases.rod import RodSpec
from solver import Initial, Rod, Scene, check_end, check_place
from solver.run.trial import FIRST_INTERVALS
from solver.scene.layout import curvature_of, nodes_at_rest
from solver.scene.rod import Profiles
from solver.scene.scene import check_frame

Part = TypeVar("Part")
KEPT = 64


def build_scene(spec: CaseSpec) -> Scene:
    """The scene that the case describes.

    Raises CaseError with the part's pointer where the parts do not fit each other, for example a
    centreline that is not as long as the rod.
    """
    rod = _part("/rod", lambda: _rod(spec.rod))
    if spec.analysis == "static":
        _part("/ends/start", lambda: check_end(build_end(spec.ends.start)))
        _part("/ends/end", lambda: check_end(build_end(spec.ends.end)))
    initial = _part("/initial", lambda: _initial(spec.initial, spec.rod.length))
    if spec.rod.kappa0 == "initial":
        intervals = spec.numerics.intervals or FIRST_INTERVALS
        kappa0 = _part("/initial", lambda: _curvature(spec.initial, spec.rod.length, intervals))
        rod = replace(rod, kappa0=kappa0)
    if spec.analysis == "dynamic":
        _check_frames(spec)
    scene = _part("", lambda: _scene(spec, rod, initial))
    if spec.analysis == "static":
        _part("/ends", lambda: check_place(scene))
    return scene


def _check_frames(spec: CaseSpec) -> None:
    ends = {0.0: spec.ends.start, spec.rod.length: spec.ends.end}
    for i, load in enumerate(spec.loads.point):
        end = build_end(ends[load.s]) if load.s in ends else None
        _part(f"/loads/point/{i}", partial(check_frame, load.build(), end))


# The cases of a sweep share most of their parts: these are kept.


@lru_cache(KEPT)
def _rod(spec: RodSpec) -> Rod:
    return spec.build()


@lru_cache(KEPT)
def _initial(spec: InitialSpec, length: float) -> Initial:
    initial = spec.build(length)
    nodes_at_rest(initial, np.array([0.0, 1e-3 * length]))  # refuses an a1 along the tangent
    return initial


@lru_cache(KEPT)
def _curvature(spec: InitialSpec, length: float, intervals: int) -> Profiles:
    """Curvature and twist of the initial shape, as profiles without corners: no joint has to look between its nodes for
    what it is free of stress by, as it lies."""
    bend1, bend2, twist = curvature_of(_initial(spec, length), length, intervals)
    return bend1.__call__, bend2.__call__, twist.__call__


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
        loads=spec.loads.others(),
        damping=spec.loads.damping,
        fluid=spec.fluid.build() if spec.fluid else None,
        contact=spec.contact.build() if spec.contact else None,
        numerics=spec.numerics.build(spec.frames),
        topology=spec.output.topology,
        analysis=spec.analysis,
    )


def _part(pointer: str, build: Callable[[], Part]) -> Part:
    try:
        return build()
    except ValueError as error:
        raise CaseError([FieldError(pointer, None, f"cannot be built: {error}")]) from error
