"""What the attempts at a tolerance say together: frames, and their errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.run.accuracy import errors_of, excess, sizes
from solver.run.plan import Attempt, Excess, chosen, intervals_of, step_series, step_tolerance
from solver.run.recording import (
    BALANCE,
    CURVATURE,
    FORCE,
    KAPPA,
    NUMBERS,
    OMEGA,
    ORIENTATION,
    WIDTH,
    WRITHE,
    Columns,
    column,
    columns_of,
    frame_of,
    number_of,
)
from solver.run.richardson import error_of_steps, extrapolate
from solver.run.verify import VerifiedFrame, unseen
from solver.scene.scene import Scene

UNVERIFIED = np.array([not output.verified for output in NUMBERS])
BESIDE = 3
"""Frames before and after one whose errors count for it."""
UNFOLLOWED = 0.02
"""Part of the tolerance of a step: by what of their largest value omega and f are in error at least, because of the
waves that no attempt follows and none therefore shows."""
AT_ONCE = 50_000
"""Nodes times frames that are looked at together."""


class Together:
    """The frames of two or three meshes of one step tolerance, extrapolated; the coarsest also with other steps.

    Where no attempt is complete: as far as the last two came. `recorded`: the rows of each attempt.
    """

    def __init__(self, scene: Scene, attempts: Sequence[Attempt], recorded: Sequence[Sequence[Array]]) -> None:
        self._scene, self._attempts, self._recorded = scene, attempts, recorded
        self._meshes, self._steps = chosen(attempts)
        self.finest = attempts[self._meshes[-1]]
        self._shorter = bool(self._steps) and attempts[self._steps[-1]].steps > self.finest.steps
        self.frames = min(len(recorded[i]) for i in self._meshes)
        """How many there are."""

    @property
    def needed(self) -> set[int]:
        """The attempts whose rows are needed, now or when finer ones come: of the coarsest mesh, and the last."""
        series = step_series(self._attempts)
        steps = {self._attempts[i].steps for i in series[-2:]}
        last = [i for i, attempt in enumerate(self._attempts) if attempt.complete and attempt.steps in steps]
        return {*self._meshes, *series, *last[-3:]}

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return np.linspace(0.0, float(self._scene.rod.length), intervals_of(self.finest.mesh) + 1)

    def frame(self, i: int) -> VerifiedFrame:
        """Frame number i.

        Its errors are the largest of those of the frames beside it: those of a wave pass through zero now and then.
        """
        first = max(i - BESIDE, 1) if i > 0 else 0  # of what is given at the start none is in error
        here = slice(first, i + BESIDE + 1) if i > 0 else slice(0, 1)
        value, error = self._of_frames(here)
        along, numbers = error.along.max(axis=0), error.numbers.max(axis=0)
        tolerated = step_tolerance(self.finest.steps, self._scene.numerics.tolerance or 1.0)
        for rows in (OMEGA, FORCE):
            largest = np.linalg.norm(value.along[..., rows], axis=-1).max()
            along[:, rows] = np.maximum(along[:, rows], UNFOLLOWED * min(tolerated, 1.0) * largest)
        value = Columns(value.along[i - first], value.numbers[i - first])
        lost = max(abs(number_of(row, BALANCE)) for row in self._recorded[self._meshes[-1]][: i + 1])
        for name, least in unseen(self._scene.rod, self.s, lost).items():
            along[:, column(name)] = np.maximum(along[:, column(name)], least)
        curvature = float(np.linalg.norm(along[:, KAPPA], axis=-1).max())
        numbers[0, CURVATURE] = max(numbers[0, CURVATURE], curvature)
        numbers[0, BALANCE] = max(numbers[0, BALANCE], abs(value.numbers[0, BALANCE]))  # of the solution it is none
        numbers = np.where(UNVERIFIED, value.numbers, numbers)
        t = float(self._recorded[self._meshes[-1]][i][0])
        return VerifiedFrame(**vars(frame_of(t, value)), error=frame_of(t, Columns(along, numbers)))

    def errors(self) -> Array:
        """The errors of the quantities of a tolerance (frames, 4), relative; see `accuracy`."""
        size = self._sizes()
        return np.concatenate([errors_of(self._of_frames(here)[1], size) for here in self._pieces()])

    def excess(self) -> Excess:
        """The error of the finest mesh, and that of the last steps but one on the coarsest, over the tolerance."""
        if not self.finest.complete:
            return Excess()
        size, target = self._sizes(), self._scene.numerics.tolerance or 1.0
        mesh, of_mesh, of_steps, series = -1, np.inf, np.inf, step_series(self._attempts)[-3:]
        if len(self._meshes) > 1:
            told = [errors_of(self._of_mesh(here)[1], size) for here in self._pieces()]
            mesh, of_mesh = self.finest.mesh, excess(target, np.concatenate(told))
        if len(series) > 1:
            told = [errors_of(self._of_steps(series, True, here, 2), size) for here in self._pieces()]
            of_steps = excess(target, np.concatenate(told))
        return Excess(of_mesh, of_steps, mesh)

    def _pieces(self) -> Iterator[slice]:
        """Frames by so many that their arrays stay small."""
        many = max(AT_ONCE // (intervals_of(self.finest.mesh) + 1), 1)
        for i in range(0, self.frames, many):
            yield slice(i, min(i + many, self.frames))

    def _sizes(self) -> Array:
        return sizes(self._scene, (columns_of(self._recorded[self._meshes[-1]][here]) for here in self._pieces()))

    def _of_frames(self, here: slice) -> tuple[Columns, Columns]:
        """The values and their errors."""
        value, mesh = self._of_mesh(here)
        steps = self._of_steps(self._steps, self._shorter, here, value.along.shape[1])
        return value, Columns(mesh.along + steps.along, mesh.numbers + steps.numbers)

    def _of_mesh(self, here: slice) -> tuple[Columns, Columns]:
        """The values and their errors by the mesh."""
        told = [columns_of(self._recorded[k][here]) for k in self._meshes]
        meshes = [_aligned(columns, told[-1]) for columns in told]
        doubled = [self._attempts[k].mesh for k in self._meshes]
        ratios = [2 ** (b - a) for a, b in pairwise(doubled)]
        values, errors = zip(*(extrapolate(series, ratios) for series in zip(*meshes, strict=True)), strict=True)
        along, numbers = values
        turned = along[..., ORIENTATION]
        along[..., ORIENTATION] = turned / np.linalg.norm(turned, axis=-1)[..., None]
        return Columns(along, np.where(UNVERIFIED, told[-1].numbers, numbers)), Columns(*errors)

    def _of_steps(self, series: Sequence[int], shorter: bool, here: slice, nodes: int) -> Columns:
        """The error by the steps at `nodes` nodes, as attempts with different steps tell it."""
        if len(series) < 2:
            many = min(here.stop, self.frames) - here.start
            return Columns(np.zeros((many, nodes, WIDTH)), np.zeros((many, 1, len(NUMBERS))))
        told = [columns_of(self._recorded[k][here]) for k in series]
        along, numbers = zip(*(_aligned(columns, told[-1]) for columns in told), strict=True)
        return Columns(error_of_steps(along, shorter, nodes), error_of_steps(numbers, shorter, 1))


def _aligned(columns: Columns, fine: Columns) -> Columns:
    """With the quaternions' signs as those of a finer mesh: a quaternion and its opposite are the same rotation; and
    with Wr as near to it as multiples of 2 turns, by which it jumps where a loop hops over an end, bring it."""
    stride = (fine.along.shape[1] - 1) // (columns.along.shape[1] - 1)
    along, numbers = columns.along.copy(), columns.numbers.copy()
    q = along[..., ORIENTATION]
    opposite = np.sum(q * fine.along[:, ::stride, ORIENTATION], axis=-1) < 0.0
    along[..., ORIENTATION] = np.where(opposite[..., None], -q, q)
    numbers[..., WRITHE] += 2.0 * np.round(0.5 * (fine.numbers[..., WRITHE] - numbers[..., WRITHE]))
    return Columns(along, numbers)
