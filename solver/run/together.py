"""What the attempts at a tolerance say together: frames, and their errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from solver.arrays import Array
from solver.run.accuracy import ENERGIES, QUANTITIES, errors_of, excess, sizes
from solver.run.first_mesh import first_intervals
from solver.run.plan import FAR_FROM_IT, WORTH, Excess
from solver.run.recording import (
    ADDED_MASS,
    ASTRAY,
    BALANCE,
    BENDING,
    CURVATURE,
    DISSIPATION,
    FORCE,
    JUDGED,
    JUDGED_KAPPA,
    JUDGED_R,
    KAPPA,
    KINETIC,
    MOMENT,
    NUMBERS,
    OMEGA,
    ORIENTATION,
    STEP,
    STRETCHING,
    TORSION,
    WIDTH,
    WRITHE,
    Columns,
    R,
    along_of,
    column,
    columns_of,
    frame_of,
    number,
    number_of,
)
from solver.run.richardson import alike, error_of_steps, extrapolate, nowhere_small, unextrapolated
from solver.run.series import Attempt, chosen, is_diagonal, step_series
from solver.run.trial import LOOSEST, grade_of, intervals_of, step_tolerance
from solver.run.unshown import Unshown
from solver.run.verify import VerifiedFrame, of_waves, unseen
from solver.scene.scene import Scene

UNVERIFIED = np.array([not output.verified for output in NUMBERS])
NOT_NEGATIVE = np.isin(np.arange(len(NUMBERS)), [KINETIC, ADDED_MASS, BENDING, TORSION, STRETCHING, CURVATURE])
"""Numbers that no state of a rod has below 0, and an extrapolation from two states that are not alike may have."""
BESIDE = 3
"""Frames before and after one whose errors count for it."""
UNFOLLOWED = 0.02
"""Part of the tolerance of a step: by what of their largest value omega and f are in error at least, because of the
waves that no attempt follows and none therefore shows."""
TURNED_OVER = [number(name) for name in ("energy_potential", "work_ends", "work_loads", "dissipation")]
ROUNDING = 1e-14
"""Part of the largest of TURNED_OVER by which the balance of energies is off for rounding alone."""
AT_ONCE = 50_000
"""Nodes times frames that are looked at together."""
FALL = 3.0
"""By how much the error of the steps is taken to fall, where nothing shows it, from one kind of steps to the next."""


@dataclass(frozen=True)
class Piece:
    """Frames of a run, from number `first` on."""

    first: int = 0
    frames: tuple[VerifiedFrame, ...] = ()

    def holds(self, i: int) -> bool:
        """Whether frame number i is one of them."""
        return self.first <= i < self.first + len(self.frames)


class Together:
    """The frames of the chosen attempts, extrapolated (see `series`). `recorded`: the rows of each attempt."""

    def __init__(self, scene: Scene, attempts: Sequence[Attempt], recorded: Sequence[Array]) -> None:
        self._scene, self._attempts, self._recorded = scene, attempts, recorded
        self._chosen, self._diagonal = chosen(attempts), is_diagonal(attempts)
        self._at_rest = scene.at_rest
        self._in_waves = np.array([float(output.name in of_waves(scene.rod)) for output in NUMBERS])
        self.finest = attempts[self._chosen.finest]
        self._intervals = intervals_of(self.finest.mesh, first_intervals(scene))
        self.frames = min(len(recorded[i]) for i in self._chosen.meshes)
        """How many there are."""

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return np.linspace(0.0, float(self._scene.rod.length), self._intervals + 1)

    def piece(self, i: int) -> Piece:
        """Frame number i and those that follow it, as many as are looked at together.

        The errors of each are the largest of those of the frames beside it: those of a wave pass through zero now and
        then. Of what is given at the start of a motion none is in error.
        """
        here = range(i, min(i + self._many, self.frames))
        first, last = max(i - BESIDE, 0), min(here.stop + BESIDE, self.frames)
        value, error = self._of_frames(slice(first, last))
        magnitudes = [np.linalg.norm(value.along[..., rows], axis=-1).max(axis=-1) for rows in (OMEGA, FORCE)]
        tolerated = 0.0 if self._at_rest else step_tolerance(self.finest.steps, self._scene.numerics.tolerance or 1.0)
        rows = self._recorded[self._chosen.finest]
        frames, exact = [], 0 if self._at_rest else 1  # how many frames at the start are given
        unfollowed = np.zeros(WIDTH)
        for k in here:
            after = min(k + BESIDE + 1, last) if k >= exact else 1
            beside = slice(max(k - BESIDE, min(k, exact)) - first, after - first)
            for columns_of_waves, magnitude in zip((OMEGA, FORCE), magnitudes, strict=True):
                unfollowed[columns_of_waves] = UNFOLLOWED * min(tolerated, 1.0) * magnitude[beside].max()
            columns = Columns(value.along[k - first], value.numbers[k - first])
            errors = Columns(error.along[beside].max(axis=0), error.numbers[beside].max(axis=0))
            frames.append(self._frame(float(rows[k][0]), columns, errors, unfollowed, float(self._lost[k])))
        return Piece(i, tuple(frames))

    def _frame(self, t: float, value: Columns, error: Columns, unfollowed: Array, lost: float) -> VerifiedFrame:
        """A frame, whose errors are those of the attempts or what none of these shows: by waves that none follows,
        `unfollowed` (WIDTH,) of the outputs along the rod, and by the energy `lost` (J)."""
        unseen, part = self._unseen, float(np.sqrt(lost))
        along = np.maximum(np.maximum(error.along, unfollowed), part * unseen.along)
        numbers = np.maximum(np.maximum(error.numbers, part * unseen.numbers), lost * self._in_waves)
        curvature = float(np.linalg.norm(along[:, KAPPA], axis=-1).max())
        numbers[0, CURVATURE] = max(numbers[0, CURVATURE], curvature)
        missed = abs(value.numbers[0, BALANCE])  # of the solution it is none
        numbers[0, BALANCE] = max(numbers[0, BALANCE], missed)
        numbers[0, DISSIPATION] = max(numbers[0, DISSIPATION], self._unfollowed * missed)  # of what is damped since too
        numbers = np.where(UNVERIFIED, value.numbers, numbers)
        return VerifiedFrame(**vars(frame_of(t, value)), error=frame_of(t, Columns(along, numbers)))

    def errors(self) -> Array:
        """The errors of the quantities of a tolerance (frames, 4), relative; see `accuracy`."""
        size, none = self._sizes(), np.zeros((0, len(QUANTITIES)))
        pieces = (errors_of(self._of_frames(here, judged=True)[1], size) for here in self._pieces())
        return self._with_lost(np.concatenate([none, *pieces]), size)

    def _with_lost(self, errors: Array, size: Array) -> Array:
        """Errors of `QUANTITIES` (frames, 4) whose energies are as uncertain as the energy is that went nowhere."""
        errors[:, ENERGIES] = np.maximum(errors[:, ENERGIES], self._lost[: len(errors)] / size[ENERGIES])
        return errors

    def excesses(self, before: Sequence[Excess]) -> list[Excess]:
        """Of each quantity the errors of the finest mesh and of its steps, over the tolerance; `before`: those before
        the last attempt."""
        if not self.finest.complete:
            return [Excess()] * len(QUANTITIES)
        size, target = self._sizes(), self._scene.numerics.tolerance or 1.0
        series = step_series(self._attempts) if self._diagonal else self._chosen.series
        mesh, steps = [], []
        for here in self._pieces():
            mesh.append(errors_of(self._of_mesh(here, judged=True)[1], size))
            steps.append(errors_of(self._of_steps(series, here, judged=True), size))
        unknown = np.full(len(QUANTITIES), np.inf)
        by_mesh, by_steps = np.concatenate(mesh), self._with_lost(np.concatenate(steps), size)
        of_mesh = excess(target, by_mesh) if len(self._chosen.meshes) > 1 else unknown
        known = len(series) > 1 or self._at_rest
        of_steps = excess(target, by_steps) if known else unknown
        anywhere = (by_mesh if self._diagonal else by_mesh + by_steps).max(axis=0) / target
        if self._diagonal:
            of_steps = np.minimum(of_steps, 0.5 * of_mesh)
            of_mesh = of_mesh - of_steps
        worth = [WORTH.get(name, np.inf) for name in QUANTITIES]
        # how an error falls says nothing as long as the meshes do not show the motion, or one part of it is untold
        far = [most == np.inf and target * max(previous.mesh, now) > FAR_FROM_IT
               for previous, now, most in zip(before, of_mesh, worth, strict=True)]  # fmt: skip
        untold = [previous.steps == np.inf > now for previous, now in zip(before, of_steps, strict=True)]
        totals = [np.inf if any(unknown) else previous.total
                  for previous, *unknown in zip(before, far, untold, strict=True)]  # fmt: skip
        each = zip(of_mesh, of_steps, totals, worth, anywhere, strict=True)
        return [Excess(*map(float, numbers)) for numbers in each]

    @cached_property
    def _unshown(self) -> Unshown:
        return Unshown(self._scene, self.s)

    @property
    def _untold(self) -> bool:
        """Whether nothing tells what the longest steps are in error: it is taken for as much as the mesh's."""
        return self.finest.steps == LOOSEST and len(self._chosen.meshes) > 1 and len(self._chosen.series) < 2

    @cached_property
    def _unseen(self) -> Columns:
        """See `unseen`, of an energy of 1 J; at rest nothing."""
        columns = Columns(np.zeros((self._intervals + 1, WIDTH)), np.zeros((1, len(NUMBERS))))
        if self._at_rest:
            return columns
        dt = float(np.mean([number_of(row, STEP) for row in self._recorded[self._chosen.finest]]))
        for name, least in unseen(self._scene.rod, self.s, 1.0, dt).items():
            part = columns.numbers[:, number(name)] if isinstance(least, float) else columns.along[:, column(name)]
            part[:] = least
        return columns

    @cached_property
    def _lost(self) -> Array:
        """The energy (J) that the finest attempt had lost by each frame in waves that no attempt follows, and that are
        not damped by then: at rest none."""
        if self._at_rest:
            return np.zeros(self.frames)
        rows = self._recorded[self._chosen.finest]
        rounded = [ROUNDING * max(abs(number_of(row, index)) for index in TURNED_OVER) for row in rows]
        astray = [max(number_of(row, ASTRAY) - least, 0.0) for row, least in zip(rows, rounded, strict=True)]
        return self._unfollowed * np.array(astray)

    @cached_property
    def _unfollowed(self) -> float:
        """Which part of the energy that the finest attempt lost was in waves that no attempt follows: what was in those
        that one with shorter steps follows shows in its difference."""
        series = self._chosen.series
        if len(series) < 2 or self._attempts[series[-1]].steps <= self.finest.steps:
            return 1.0
        longer, shorter = series[-2:]
        lost, left = (abs(number_of(self._recorded[i][-1], BALANCE)) for i in (longer, shorter))
        return float(min(left / lost, 1.0)) if lost > 0.0 else 1.0

    @property
    def _many(self) -> int:
        return max(AT_ONCE // (self._intervals + 1), 1)

    def _pieces(self) -> Iterator[slice]:
        """Frames by so many that their arrays stay small."""
        for i in range(0, self.frames, self._many):
            yield slice(i, min(i + self._many, self.frames))

    def _sizes(self) -> Array:
        return sizes(self._scene, (self._columns(self._chosen.finest, here, judged=True) for here in self._pieces()))

    def _columns(self, i: int, here: slice, judged: bool) -> Columns:
        return columns_of(self._recorded[i][here], judged)

    def _of_frames(self, here: slice, judged: bool = False) -> tuple[Columns, Columns]:
        """The values and their errors; here and below of all columns or of those that are `judged`."""
        value, mesh = self._of_mesh(here, judged)
        steps = mesh if self._untold else self._of_steps(self._chosen.series, here, judged)
        return value, Columns(mesh.along + steps.along, mesh.numbers + steps.numbers)

    def _of_mesh(self, here: slice, judged: bool) -> tuple[Columns, Columns]:
        """The values and their errors by the mesh, on a diagonal by mesh and steps."""
        finest = self._columns(self._chosen.finest, here, judged)
        meshes = [_aligned(self._columns(k, here, judged), finest, judged) for k in self._chosen.meshes]
        doubled = [self._attempts[k].mesh for k in self._chosen.meshes]
        if self._chosen.coarser:
            longer, beside = (_aligned(self._columns(k, here, judged), finest, judged) for k in self._chosen.coarser)
            along, numbers = (shorter - of for shorter, of in zip(meshes[0], beside, strict=True))
            meshes.insert(0, Columns(longer.along + along[:, ::2], longer.numbers + numbers))
            doubled.insert(0, doubled[0] - 1)
        value, error = self._extrapolated(meshes, doubled)
        if self._unshown.any:
            self._widen(error.along, here, judged)
        along = finest.along + (value.along - meshes[-1].along)
        numbers = possible(finest.numbers + (value.numbers - meshes[-1].numbers), finest.numbers)
        if not judged:
            turned = along[..., ORIENTATION]
            turned /= np.sqrt(np.sum(turned**2, axis=-1))[..., None]
        return Columns(along, numbers), error

    def _widen(self, errors: Array, here: slice, judged: bool) -> None:
        """Take for errors along the rod at least what the finest mesh does not show: see `unshown`."""
        aside, moments, kappa = self._unshown.of(along_of(self._recorded[self._chosen.finest][here]))
        least = [(JUDGED_R, aside[:, None, None]), (JUDGED_KAPPA, kappa)]
        if not judged:
            least = [(R, aside[:, None, None]), (KAPPA, kappa), (MOMENT, moments)]
        for columns_of_output, floor in least:
            part = errors[..., columns_of_output]
            np.maximum(part, floor, out=part)

    def _extrapolated(self, meshes: Sequence[Columns], doubled: Sequence[int]) -> tuple[Columns, Columns]:
        """What meshes say together, and its error; `doubled`: their numbers."""
        ratios = [2 ** (b - a) for a, b in pairwise(doubled)]
        combine = extrapolate if grade_of(self.finest.steps) is None else unextrapolated
        values, errors = zip(*(combine(series, ratios) for series in zip(*meshes, strict=True)), strict=True)
        return Columns(*values), Columns(*errors)

    def _of_steps(self, series: Sequence[int], here: slice, judged: bool) -> Columns:
        """The error by the steps, as a series of attempts with different ones tells it; none where nothing tells it."""
        nodes = self._intervals + 1
        if len(series) < 2:
            many = min(here.stop, self.frames) - here.start
            return Columns(np.zeros((many, nodes, len(JUDGED) if judged else WIDTH)), np.zeros((many, 1, len(NUMBERS))))
        columns = [self._columns(k, here, judged) for k in series]
        along, numbers = zip(*(_aligned(attempt, columns[-1], judged) for attempt in columns), strict=True)
        longer = self.finest.steps - self._attempts[series[-1]].steps
        part = FALL ** -max(longer, 0) * alike(*(self._attempts[i].work for i in series[-2:]))
        error = Columns(*(part * error_of_steps(values, longer < 0, n) for values, n in ((along, nodes), (numbers, 1))))
        return Columns(*map(np.minimum, error, self._of_diagonal(here, judged))) if self._chosen.diagonal else error

    def _of_diagonal(self, here: slice, judged: bool) -> Columns:
        """What the finest's steps are in error at the most: as much as with the mesh of the last on the diagonal."""
        finest = self._columns(self._chosen.finest, here, judged)
        meshes = [_aligned(self._columns(k, here, judged), finest, judged) for k in self._chosen.diagonal]
        error = self._extrapolated(meshes, [self._attempts[k].mesh for k in self._chosen.diagonal])[1]
        return Columns(nowhere_small(error.along, self._intervals + 1), error.numbers)


def possible(numbers: Array, finest: Array) -> Array:
    """Extrapolated `NUMBERS`, or those of the finest mesh where nothing is extrapolated or no rod has them."""
    return np.where(UNVERIFIED | (NOT_NEGATIVE & (numbers < 0.0)), finest, numbers)


def _aligned(columns: Columns, fine: Columns, judged: bool) -> Columns:
    """With Wr as near to that of a finer mesh as multiples of 2 turns, by which it jumps where a loop hops over an end,
    bring it; and with the quaternions' signs as there, if all columns are looked at: a quaternion and its opposite are
    the same rotation."""
    Wr = columns.numbers[..., WRITHE]
    Wr += 2.0 * np.round(0.5 * (fine.numbers[..., WRITHE] - Wr))
    if not judged:
        stride = (fine.along.shape[1] - 1) // (columns.along.shape[1] - 1)
        q = columns.along[..., ORIENTATION]
        q[np.sum(q * fine.along[:, ::stride, ORIENTATION], axis=-1) < 0.0] *= -1.0
    return columns
