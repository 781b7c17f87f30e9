"""What is declared of each output, and that a frame's values are of the declared kind."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from solver import Curve, End, Frame, Initial, Numerics, Scene, VerifiedFrame, simulate
from solver.measures.energies import Energies
from solver.measures.frame import OUTPUTS, Fields
from tests.solver.bent import bent_cantilever
from tests.solver.scenes import BEND, LENGTH, ROD, arc, last

STAGGERED = Numerics(method="staggered", intervals=6, dt_max=0.05)


def short(numerics: Numerics) -> Scene:
    return replace(bent_cantilever(numerics), t_end=0.5)


def test_every_value_of_a_frame_but_its_time_is_declared():
    assert {output.name for output in OUTPUTS} == {field.name for field in fields(Frame)} - {"t"}
    assert all(output.units and output.long_name for output in OUTPUTS)


def test_what_a_method_gives_lies_along_the_rod():
    declared = {output.name: output.along_rod for output in OUTPUTS}
    assert all(declared[field.name] for field in fields(Fields))


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_the_largest_curvature_is_that_of_the_centreline_whatever_the_twist(method):
    twisted = Initial(arc, twist=Curve.table([0.0, LENGTH], [0.0, 3.0]))
    scene = Scene(rod=ROD, initial=twisted, start=End.clamp(), end=End.free(), t_end=0.1, output_interval=0.1,
                  numerics=Numerics(method=method, intervals=100, dt_max=0.05))  # fmt: skip
    assert next(iter(simulate(scene))).max_curvature == pytest.approx(BEND / LENGTH, rel=1e-3)


def test_the_largest_curvature_of_a_cantilever_is_within_its_error_bars():
    numerics = Numerics(method="staggered", intervals=20, verify=True)
    frame = last(replace(bent_cantilever(numerics), analysis="static"))
    assert isinstance(frame, VerifiedFrame)
    at_the_clamp = 3.0 / LENGTH**2 * frame.r[-1, 2]  # the load's moment over EJ
    assert 0.0 < frame.error.max_curvature < 1e-3 * at_the_clamp
    assert frame.max_curvature == pytest.approx(at_the_clamp, abs=3.0 * frame.error.max_curvature)


@pytest.mark.parametrize(
    "scene",
    [
        short(Numerics(intervals=6, dt_max=0.05)),
        short(STAGGERED),
        replace(short(STAGGERED), analysis="static"),
        short(replace(STAGGERED, verify=True)),
    ],
    ids=["box", "staggered", "static", "verified"],
)
def test_values_have_the_declared_shape_and_type(scene):
    frame = last(scene)
    for each in (frame, frame.error) if isinstance(frame, VerifiedFrame) else (frame,):
        for output in OUTPUTS:
            value = np.asarray(getattr(each, output.name))
            components = (output.components,) if output.axes else ()
            assert value.shape == ((7,) if output.along_rod else ()) + components, output.name
            assert value.dtype.kind == {"f8": "f", "i4": "i"}[output.type], output.name


def test_outputs_that_begin_with_energy_are_what_is_stored_and_the_balance() -> None:
    """Users add them up, as the command's summary does."""
    names = {output.name for output in OUTPUTS if output.name.startswith("energy_")}
    stored = {f"energy_{name}" for name in (*Energies._fields, "contact")}
    assert names == stored | {"energy_balance"}
