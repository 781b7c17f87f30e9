"""Parts of datasets as bytes."""

from __future__ import annotations

import gc

import netCDF4
import numpy as np
import pytest

from service.results.formats import as_netcdf
from service.results.part import Column, Part


def test_a_file_that_cannot_be_written_is_closed_before_another_is_begun():
    """The garbage collector would close it in some thread, while another is in the library: a program ends by that."""
    half = Column("half", ("time",), np.zeros(3, np.complex64))
    with pytest.raises(TypeError, match="complex") as raised:
        as_netcdf(Part((), (Column("whole", ("time",), np.zeros(3)), half)))
    files = [each for each in gc.get_objects() if issubclass(type(each), netCDF4.Dataset)]
    assert raised and files and not [file for file in files if file.isopen()]
