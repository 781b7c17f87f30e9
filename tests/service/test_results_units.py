"""The units of a dataset, as others read them."""

from __future__ import annotations

import pytest
import xarray as xr
from cf_units import Unit

from service.results import DatasetWriter
from service.results.schema import COORDINATES, VARIABLES
from tests.service.frames import ended, frames, small_spec

UNITS = sorted({variable.units for variable in VARIABLES} | {told["units"] for told in COORDINATES.values()})


@pytest.mark.parametrize("unit", UNITS)
def test_udunits_and_pint_read_a_unit_alike(unit):
    registry = pytest.importorskip("pint").UnitRegistry()
    theirs = registry.Quantity(1.0, unit).to_base_units()
    base = Unit(f"{theirs.units:~C}".replace("**", "^") or "1")
    assert Unit(unit).convert(1.0, base) == pytest.approx(theirs.magnitude)


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_needs_no_powers_by_sign(unit):
    """`m s-1` is UDUNITS only: pint takes it for a difference."""
    assert "-" not in unit and Unit(unit)


def test_pint_xarray_takes_a_dataset_as_it_is(tmp_path):
    pytest.importorskip("pint_xarray")
    spec = small_spec()
    with DatasetWriter(tmp_path / "x.nc", spec) as writer:
        for frame in frames(spec, 2):
            writer.append(frame)
        writer.publish("completed", "", ended(spec))
    with xr.open_dataset(tmp_path / "x.nc") as dataset:
        quantified = dataset.pint.quantify()
        assert str(quantified.v.pint.units) == "meter / second"
        assert str(quantified.Tw.pint.to("radian").pint.units) == "radian"
