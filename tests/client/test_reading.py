"""Files that are read from memory: many side by side, and none left open."""

from __future__ import annotations

import gc
from concurrent.futures import ThreadPoolExecutor

import netCDF4
import numpy as np
import pytest

from hockle_client.reading import read

VALUES = np.arange(100.0)


@pytest.fixture
def content() -> bytes:
    file = netCDF4.Dataset("x.nc", "w", memory=1)
    file.createDimension("time", VALUES.size)
    file.createVariable("Tw", "f8", ("time",))[:] = VALUES
    return bytes(file.close())


def test_threads_read_side_by_side_and_leave_no_file_open(content):
    with ThreadPoolExecutor(4) as pool:
        datasets = list(pool.map(lambda number: read(content, f"{number}.nc"), range(40)))
    assert all(np.array_equal(dataset.Tw, VALUES) for dataset in datasets)
    files = [each for each in gc.get_objects() if isinstance(each, netCDF4.Dataset)]
    assert not [file for file in files if file.isopen()]
