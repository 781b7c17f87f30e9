"""How accurate a run is, by its own estimate, in the quantities that a tolerance is meant for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.physics.elasticity import elasticity_of, principal
from solver.run import recording
from solver.run.recording import Columns
from solver.scene.scene import Scene

QUANTITIES = ("r", "kappa", "energies", "Tw_Wr")
"""`r`: the largest error of a node, in rod lengths; `kappa`: rms along the rod, relative to its largest rms;
`energies`: of bending, torsion, stretching and motion, relative to their largest sum; `Tw_Wr`: of either, in turns."""
ENERGIES = QUANTITIES.index("energies")
WHERE_IT_COUNTS = 0.95
"""Part of the frames in which kappa and Tw, Wr must keep the tolerance: where a moment jumps, no mesh resolves it at
once, and where a plane curve crosses itself Wr is that of either side."""
STANDS_OUT = 3.0
"""How many times larger than in the rest the error of some frames must be for them to be left out so."""
SMALL_BEND = 1e-4
"""Total curvature (rad) that counts as none, so that a straight rod's rounding errors are not to be resolved."""

KAPPA_ALONE = (" All but the curvature keep it, which is not resolved where waves run along the rod, or where a limp "
               "or a taut one bends within less than an interval.")  # fmt: skip


@dataclass(frozen=True)
class Accuracy:
    """The estimated errors of a run: of each quantity the largest of all frames, and in how many it is beyond.

    `target`: the tolerance; `frames`: how many there are; `errors` and `beyond` by `QUANTITIES`. An error that nothing
    tells is NaN, and beyond.
    """

    target: float
    frames: int
    errors: dict[str, float]
    beyond: dict[str, int]

    @property
    def unknown(self) -> bool:
        """Whether nothing tells the errors."""
        return bool(np.isnan(self.errors["r"]))

    @property
    def met(self) -> bool:
        """Whether every quantity keeps the tolerance in all frames."""
        return not any(self.beyond.values())

    def attributes(self) -> dict[str, float | int | str]:
        """By the names that a dataset gives them."""
        errors = {f"error_{name}": error for name, error in self.errors.items()}
        beyond = {f"frames_beyond_{name}": count for name, count in self.beyond.items()}
        return {"tolerance": self.target, "tolerance_met": "yes" if self.met else "no", **errors, **beyond}

    def sentence(self) -> str:
        """What a user is to read."""
        if self.unknown:
            return "Nothing tells the errors: only one run came that far."
        errors = ", ".join(f"{_words(name)} {error:.1e}" for name, error in self.errors.items())
        if self.met:
            return f"Estimated errors: {errors}; the tolerance of {self.target:g} is kept."
        beyond = ", ".join(f"{_words(name)} in {count}" for name, count in self.beyond.items() if count)
        frames = f"of {self.frames} frames {beyond}"
        alone = KAPPA_ALONE if not any(count for name, count in self.beyond.items() if name != "kappa") else ""
        return f"Estimated errors: {errors}; beyond the tolerance of {self.target:g} are, {frames}.{alone}"


def _words(name: str) -> str:
    return name.replace("_", ", ")


def sizes(scene: Scene, pieces: Iterable[Columns]) -> Array:
    """What the errors of `QUANTITIES` (4,) are relative to; `pieces`: the `JUDGED` columns of a run."""
    length = float(scene.rod.length)
    bend = SMALL_BEND / length
    stiffness = float(principal(elasticity_of(scene.rod, np.array([0.5 * length])))[0, 0])
    kappa, energy = bend, 0.0
    for columns in pieces:
        kappa = max(kappa, float(_rms(columns.along[..., recording.JUDGED_KAPPA]).max()))
        energy = max(energy, float(np.sum(_energies(columns), axis=-1).max()))
    # an error of kappa by the tolerance is worth this times the tolerance, where the rod has no stress
    worth = 0.5 * stiffness * length * max(bend**2, (scene.numerics.tolerance or 0.0) * kappa**2)
    return np.array([length, kappa, max(worth, energy), 1.0])


def errors_of(error: Columns, size: Array) -> Array:
    """The errors of `QUANTITIES` (frames, 4), from those of the `JUDGED` columns, relative to `sizes`."""
    place = np.linalg.norm(error.along[..., recording.JUDGED_R], axis=-1).max(axis=-1)
    topology = np.nan_to_num(error.numbers[:, 0, [recording.TWIST, recording.WRITHE]])  # NaN where the output has none
    topology[np.isnan(place)] = np.nan  # or where nothing tells the errors
    kappa, energies = _rms(error.along[..., recording.JUDGED_KAPPA]), _energies(error).max(axis=-1)
    return np.asarray(np.column_stack([place, kappa, energies, topology.max(axis=-1)]) / size)


def judge(target: float, errors: Array) -> Accuracy:
    """What the errors (frames, 4) of a run say."""
    return Accuracy(
        target, len(errors), dict(zip(QUANTITIES, map(float, errors.max(axis=0)), strict=True)),
        dict(zip(QUANTITIES, map(int, (~(errors <= target)).sum(axis=0)), strict=True)),
    )  # fmt: skip


def excess(target: float, errors: Array) -> Array:
    """The largest error that counts of each quantity (4,), over the target; `errors`: (frames, 4)."""
    counted = errors.max(axis=0)
    most = np.quantile(errors[:, [1, 3]], WHERE_IT_COUNTS, axis=0)
    counted[[1, 3]] = np.where(counted[[1, 3]] > STANDS_OUT * most, most, counted[[1, 3]])
    return np.asarray(counted / target)


def _rms(field: Array) -> Array:
    """Of vectors (..., nodes, 3) along the rod."""
    return np.asarray(np.sqrt(np.mean(np.sum(field**2, axis=-1), axis=-1)))


def _energies(columns: Columns) -> Array:
    """Of bending, torsion, stretching and motion, (frames, 4)."""
    numbers = columns.numbers[:, 0]
    motion = numbers[:, recording.KINETIC] + numbers[:, recording.ADDED_MASS]
    strains = recording.BENDING, recording.TORSION, recording.STRETCHING
    return np.stack([*(numbers[:, strain] for strain in strains), motion], axis=-1)
