"""Loads that a user gives as Python classes (`scene.loads.UserLoad`), called back from the kernels of a step.

Kernels hand over places and velocities, and take forces and tangents, in arrays that they share with Python. They know
the function that fills these by its address alone; so a user's load compiles nothing, and costs the time of Python.
"""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_int64, c_void_p, cast
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from solver.arrays import Array
from solver.kernels.kernel import inner
from solver.kernels.vectors import matrix, vector
from solver.physics.loads.load import Account, Point, Samples, Source, Tangents, point
from solver.scene.scene import Scene
from solver.scene.user import UserLoad

STEADY = 1e-9
"""Part of the largest energy by which that of a load may change with time."""


class Record(NamedTuple):
    """`account`; `address` (1,) of what fills the arrays; places and velocities `r`, `V` (n, 3), lab; `forces` (n, 3)
    in N/m, `K`, `C` (n, 3, 3) their derivatives, and `stored` (n,) in J/m."""

    present: bool
    account: int
    address: Any
    r: Any
    V: Any
    forces: Any
    K: Any
    C: Any
    stored: Any


_CALL = CFUNCTYPE(c_int64, c_int64, c_int64)


class UserLoads(Source):
    """The user's loads of one account, called back from kernels."""

    def __init__(self, loads: tuple[UserLoad, ...], samples: Samples, account: Account) -> None:
        n = len(samples.s)
        (r, V, forces), (K, C) = np.zeros((3, n, 3)), np.zeros((2, n, 3, 3))
        self._loads, self._s, self._times = loads, samples.s, [0.0] * samples.times
        self._function = _CALL(self._call)
        address = np.array([cast(self._function, c_void_p).value], np.int64)
        super().__init__(Record(bool(loads), int(account), address, r, V, forces, K, C, np.zeros(n)))
        self.steady = not loads
        self.corners = tuple(corner for load in loads for corner in load.corners)
        self._failure: list[Exception] = []

    def set_time(self, t: float, i: int) -> None:
        """Remember the time at which the loads will be asked for."""
        self._times[i] = t

    def check(self) -> None:
        """Raise what a user's load raised."""
        if self._failure:
            raise self._failure.pop()

    def _call(self, i: int, linearise: int) -> int:
        """Fill the record's arrays; no exception may leave this for a kernel."""
        try:
            self._fill(self._times[i], bool(linearise))
        except Exception as failure:  # whatever a user's code raises
            self._failure = [failure]
            self.record.forces[:] = np.nan
        return 0

    def _fill(self, t: float, linearise: bool) -> None:
        load, s = self.record, self._s
        for array in (load.forces, load.stored, load.K, load.C):
            array[:] = 0.0
        for source in self._loads:
            load.forces[:] += source.force(t, s, load.r, load.V)
            if source.account == "stored":
                load.stored[:] += source.energy(t, s, load.r)
            if linearise:
                _require_steady(source, t, s, load.r)
                K, C = source.tangents(t, s, load.r, load.V)
                load.K[:] += K
                load.C[:] += C


def _require_steady(load: UserLoad, t: float, s: Array, r: Array) -> None:
    """Raise ValueError where a stored load's energy changes though nothing moves: nobody would have given it."""
    if load.account != "stored":
        return
    now, first = load.energy(t, s, r), load.energy(0.0, s, r)
    if np.abs(now - first).max() > STEADY * np.abs(now).max():
        raise ValueError(f"{type(load).__name__}: the energy of a load that is stored must not change with time; "
                         'one that acts by the time has account = "given"')  # fmt: skip


@intrinsic
def _call_back(_context: Any, address: Any, _i: Any, _linearise: Any) -> Any:
    """Call the function at an address."""

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        number = ir.IntType(64)
        function = builder.inttoptr(arguments[0], ir.FunctionType(number, [number, number]).as_pointer())
        return builder.call(function, arguments[1:])

    return types.int64(address, types.int64, types.int64), generate


@inner
def prepare(load: Record, i: int, motion: Any, linearise: bool) -> None:
    """Hand over where the points are, and have the arrays filled."""
    for j in range(len(load.r)):
        at = point(motion, j)
        for k in range(3):
            load.r[j, k], load.V[j, k] = at.r[k], at.V[k]
    _call_back(load.address[0], i, 1 if linearise else 0)  # type: ignore[call-arg]


@inner
def force(load: Record, i: int, j: int, at: Point) -> Any:
    """As the user's function gave it."""
    return vector(load.forces, j), None


@inner
def tangents(load: Record, i: int, j: int, at: Point) -> Tangents:
    """As the user's function gave them."""
    return Tangents(matrix(load.K, j), matrix(load.C, j), None, None, None, None, None)


@inner
def energy(load: Record, i: int, j: int, at: Point) -> float:
    """As the user's function gave it."""
    return float(load.stored[j])


@inner
def account(load: Record) -> int:
    """As the user says."""
    return load.account


def _kind(what: Account) -> SimpleNamespace:
    """The load that all the user's loads of an account make together."""
    name = what.name.lower()

    def of(scene: Scene, samples: Samples) -> Source:
        loads = (load for load in scene.loads if isinstance(load, UserLoad) and load.account == name)
        return UserLoads(tuple(loads), samples, what)

    return SimpleNamespace(__name__=f"user_{name}", Given=UserLoad, Record=Record, of=of, prepare=prepare, force=force,
                           tangents=tangents, energy=energy, account=account)  # fmt: skip


KINDS = tuple(_kind(what) for what in (Account.GIVEN, Account.LOST, Account.STORED))
