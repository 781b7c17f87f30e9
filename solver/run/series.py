"""Which of the attempts at a tolerance make the frames, and which tell their errors."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple


class Attempt(NamedTuple):
    """A run that was tried: its `mesh` and `steps` (see `plan`), its `work`, the time `t` (s) that it reached, whether
    it is `complete`, whether it was `slow`: given up because it would have taken too long, the number of its
    `outcome` among all, and how far it is `apart` from the motion: the largest relative error of its mesh, once told.
    """

    mesh: int
    steps: int
    work: float
    t: float
    complete: bool
    slow: bool
    outcome: int = 0
    apart: float = inf


class Chosen(NamedTuple):
    """Numbers of attempts.

    `finest`: whose nodes and values the frames have. `meshes`: up to three, the coarsest first, the last on the same
    mesh as the finest, which tell the error of the mesh: of the same steps, or, where each has shorter steps than the
    one before (a diagonal), of mesh and steps together. `series`: up to three on one mesh, those with the longest
    steps first, which tell the error of the steps; empty where `meshes` tells it or nothing does. `coarser`: where
    `meshes` are two, and longer steps were tried on the first of them and on the mesh before it, the attempts with
    these, the coarser one first. What the steps change on the one mesh they are taken to change on the other, which is
    a third one then, and tells how the error falls. `diagonal`: where the `series` have longer steps than the finest,
    the attempts that end with one of its steps on a coarser mesh, and tell the error of these steps with that mesh's.
    """

    finest: int
    meshes: list[int]
    series: list[int]
    coarser: tuple[int, ...] = ()
    diagonal: tuple[int, ...] = ()

    @property
    def many(self) -> int:
        """How many meshes tell the error of the finest."""
        return len(self.meshes) + (len(self.coarser) > 0)


def chosen(attempts: Sequence[Attempt]) -> Chosen:
    """Which attempts make the frames; where none is complete, the last two that went as far as they could."""
    complete = [i for i, attempt in enumerate(attempts) if attempt.complete]
    if not complete:
        last = [i for i, attempt in enumerate(attempts) if not attempt.slow][-2:] or [len(attempts) - 1]
        return Chosen(last[-1], last, [])
    finest = max(complete, key=lambda i: (attempts[i].mesh, attempts[i].steps))
    series = step_series(attempts)
    until = [i for i in series if attempts[i].steps <= attempts[finest].steps + 1]
    by_steps = until[-3:] if len(until) > 1 else []
    same = _chain(attempts, finest, 0)
    if len(same) > 1:
        below = _chain(attempts, same[-2], 1)
        known = len(below) < 2 or attempts[series[-1]].steps >= attempts[finest].steps
        return Chosen(finest, same, by_steps, _coarser(attempts, same), () if known else tuple(below))
    diagonal = _chain(attempts, finest, 1)
    on_mesh = [i for i in complete if attempts[i].mesh == attempts[finest].mesh]
    chains = [_chain(attempts, i, 0) for i in sorted(on_mesh, key=lambda i: -attempts[i].steps)]
    longer = next((chain for chain in chains if len(chain) > 1), [])
    if longer and finest in by_steps:
        return Chosen(finest, longer, by_steps, _coarser(attempts, longer))
    if len(diagonal) > 1:
        return Chosen(finest, diagonal, [])
    return Chosen(finest, longer or [finest], by_steps)


def _coarser(attempts: Sequence[Attempt], meshes: Sequence[int]) -> tuple[int, ...]:
    """See `Chosen`; of several the attempts whose steps are nearest."""
    mesh, steps = attempts[meshes[0]][:2]
    by_resolution = {(attempt.mesh, attempt.steps): i for i, attempt in enumerate(attempts) if attempt.complete}
    longer = [k for m, k in by_resolution if m == mesh and k < steps and (mesh - 1, k) in by_resolution]
    if len(meshes) != 2 or not longer:
        return ()
    return by_resolution[mesh - 1, max(longer)], by_resolution[mesh, max(longer)]


def is_diagonal(attempts: Sequence[Attempt]) -> bool:
    """Whether the chosen meshes have steps of their own each."""
    meshes = chosen(attempts).meshes
    return len(meshes) > 1 and attempts[meshes[-1]].complete and attempts[meshes[0]].steps != attempts[meshes[-1]].steps


def step_series(attempts: Sequence[Attempt]) -> list[int]:
    """The complete attempts on the finest mesh that has several of them, or else on the finest, those with the longest
    steps first."""
    complete = [i for i, attempt in enumerate(attempts) if attempt.complete]
    meshes = [attempts[i].mesh for i in complete]
    mesh = max(meshes, key=lambda mesh: (meshes.count(mesh) > 1, mesh), default=0)
    return sorted((i for i in complete if attempts[i].mesh == mesh), key=lambda i: attempts[i].steps)


def _chain(attempts: Sequence[Attempt], end: int, shift: int) -> list[int]:
    """Up to three complete attempts on ever finer meshes, the last of them `end`; each has steps that are shorter by
    `shift` for every doubling of the mesh."""
    by_resolution = {(attempt.mesh, attempt.steps): i for i, attempt in enumerate(attempts) if attempt.complete}
    mesh, steps, chain = attempts[end].mesh, attempts[end].steps, [end]
    for coarser in range(mesh - 1, -1, -1):
        before = by_resolution.get((coarser, steps - shift * (mesh - coarser)))
        if before is not None and len(chain) < 3:
            chain.insert(0, before)
    return chain
