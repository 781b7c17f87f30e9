"""Elasticity, eq. (1) of Goyal, Perkins & Lee 2003: q = K (kappa - kappa0), in the material frame.

The only place that knows stiffness. K is symmetric, so half of strain . K strain, strain = kappa - kappa0, is the
energy that the moment conserves. About one axis K and kappa0 are numbers.

A law of the bend, b = sqrt(strain1^2 + strain2^2), adds its energy U(b), so U'/b (strain1, strain2, 0) to q. Where a
rod has one, q is not linear in kappa.

A rod with a law of stretch lengthens, r_s = (1 + eps) a3, by the tension N = f . a3. Its complementary energy per
length, U - N eps with the energy U, is a function of kappa and N; eps is minus its derivative by N, and q that by
kappa. So what N adds to q and what kappa adds to eps go together: dq / dN = - d eps / d kappa.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import sqrt
from typing import Any, ClassVar, NamedTuple

import numba
import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import by_type, inlined, inner, kernel
from solver.kernels.vectors import add, dot, minus, plus, stiffness, times, transform, vector_product
from solver.kernels.vectors import vector as line
from solver.physics.cells import Cells
from solver.scene.curve import Curve
from solver.scene.rod import Profile, Rod
from solver.scene.view import View


@dataclass(frozen=True)
class Coupling:
    """Bending coupled with torsion and with bending about the other axis: K23, K13, K12 (N m^2) along s.

    DNA couples twist with its roll: K23 of Marko & Siggia, Macromolecules 27 (1994) 981, eq. (1).
    """

    K23: Profile = field(default_factory=lambda: Curve.constant(0.0))
    K13: Profile = field(default_factory=lambda: Curve.constant(0.0))
    K12: Profile = field(default_factory=lambda: Curve.constant(0.0))


@dataclass(frozen=True)
class Stretch:
    """Stretch by the tension, eps = N / EA: the axial stiffness EA (N) along s. The section stays as it is."""

    EA: Profile
    along: ClassVar[bool] = True
    """A rod that stays straight, or in a plane, does so with it too."""


@dataclass(frozen=True)
class TwistStretch:
    """Torsion coupled with stretch, of a rod that has a law of `Stretch`: the coupling g (N m) along s, in the energy

        1/2 EA eps^2 + g eps (kappa3 - kappa0_3) + 1/2 GJ (kappa3 - kappa0_3)^2

    per length. Cables whose wires lie at an angle have it, and DNA: Gore et al., Nature 442 (2006) 836.
    """

    g: Profile
    along: ClassVar[bool] = True
    """See `Stretch`."""


class _AlongStrain:
    """What a law is that adds a moment along the strain, or along its rate as K has it."""

    def keeps(self, view: View) -> bool:
        """About any axis."""
        return True


@dataclass(frozen=True)
class Softening(_AlongStrain):
    """Bending that softens: EJ (N m^2) along s, by which a rod is stiffer until its curvature is `kappa` (1/m).

    A law of the bend b: U = EJ kappa^2 (sqrt(1 + (b / kappa)^2) - 1), so the moment grows by EJ b at first, and in all
    by EJ kappa. Umbilicals and flexible pipes bend so, whose layers stick to each other, then slip: Feret & Bournazel,
    J. Offshore Mech. Arct. Eng. 109 (1987) 263. Without the friction's hysteresis.
    """

    EJ: Profile
    kappa: Profile


@dataclass(frozen=True)
class Locking(_AlongStrain):
    """Bending that locks: EJ (N m^2) along s, by which a rod is stiffer where its curvature is beyond `kappa` (1/m).

    A law of the bend b: U = EJ/2 (b - kappa)^2 beyond kappa. Bend restrictors do so, whose links come to lie on each
    other at their smallest radius, 1/kappa.
    """

    EJ: Profile
    kappa: Profile


@dataclass(frozen=True)
class Viscosity(_AlongStrain):
    """A material that resists its own bending and twisting: the retardation time (s) along s.

    Kelvin's and Voigt's: K kappa_t times that time is added to q, with the linear law's K.
    """

    time: Profile


class Elasticity(NamedTuple):
    """At n arclengths: `K` (n, 3, 3) in N m^2, stress-free `kappa0` (n, 3) in rad/m; about one axis (n,) each.

    Of a rod that can stretch (n,), else (0,): `compliance` 1/EA in 1/N, and what the tension adds to q3, `by_tension`
    g/EA in m. K is at a given tension, its torsional stiffness GJ - g^2/EA. EJ and kappa of
    `softening` and of `locking`, (n, 2) where the rod has it, else (0, 2). `viscosity`: what q gains by kappa_t, (n, 3,
    3) in N m^2 s, else (0, 3, 3).
    """

    K: Array
    kappa0: Array
    compliance: Array
    by_tension: Array
    softening: Array
    locking: Array
    viscosity: Array


def elasticity_of(rod: Rod, s: Array) -> Elasticity:
    """That of a rod at arclengths s (n,). Raises TypeError for a law that is not known here."""
    K, compliance, g = np.zeros((len(s), 3, 3)), np.zeros(0), np.zeros(len(s))
    (softening, locking), time = np.zeros((2, 0, 2)), np.zeros(0)
    for i, profile in enumerate(rod.stiffness):
        K[:, i, i] = profile(s)
    for law in rod.laws:
        if isinstance(law, Coupling):
            for (i, j), profile in zip(((1, 2), (0, 2), (0, 1)), (law.K23, law.K13, law.K12), strict=True):
                K[:, i, j] = K[:, j, i] = K[:, i, j] + profile(s)
        elif isinstance(law, Stretch):
            compliance = 1.0 / _positive("EA", "N", law.EA(s))
        elif isinstance(law, TwistStretch):
            g = g + law.g(s)
        elif isinstance(law, Softening):
            softening = _of_law(law, s)
        elif isinstance(law, Locking):
            locking = _of_law(law, s)
        elif isinstance(law, Viscosity):
            time = _positive("time", "s", law.time(s)) + (time if len(time) else 0.0)
        else:
            raise TypeError(f"a law of elasticity must be of a kind that physics.elasticity knows, got {law!r}")
    by_tension = _coupled(g, compliance, K[:, 2, 2])
    if rod.laws and not np.linalg.eigvalsh(K).min() > 0.0:
        raise ValueError("stiffness must be positive definite along the rod: the coupling must be smaller")
    kappa0 = np.ascontiguousarray(np.stack([profile(s) for profile in rod.kappa0], axis=1))
    return Elasticity(K, kappa0, compliance, by_tension, softening, locking, time[:, None, None] * K[: len(time)])


def elasticity_over(elastic: Elasticity, cells: Cells) -> Elasticity:
    """What `elastic` at their points counts for in cells; of K that by which they bend as much under a moment, the
    inverse of the mean of 1/K. kappa0 is that of the cells' own points."""
    if len(cells.crossed) == 0:
        return elastic
    mean = Elasticity(*(cells.mean(values) if len(values) else values for values in elastic))
    flexibility = cells.mean(np.asarray(np.linalg.inv(elastic.K), dtype=np.float64))
    mean.K[cells.crossed] = np.linalg.inv(flexibility[cells.crossed])
    return mean._replace(kappa0=elastic.kappa0[: len(mean.K)])


def _coupled(g: Array, compliance: Array, GJ: Array) -> Array:
    """g / EA, of a coupling g (n,) of torsion and stretch; GJ (n,) becomes that at a given tension."""
    if len(compliance) == 0:
        if g.any():
            raise ValueError("g, the coupling of torsion and stretch, must be 0 N m for a rod without EA, "
                             f"got {g[np.argmax(np.abs(g))]}")  # fmt: skip
        return np.zeros(0)
    largest = np.sqrt(GJ / compliance)
    if not (np.abs(g) < largest).all():
        worst = int(np.argmax(np.abs(g) - largest))
        raise ValueError("g, the coupling of torsion and stretch, must be between -sqrt(EA GJ) and sqrt(EA GJ) = "
                         f"{largest[worst]:.6g} N m, got {g[worst]}")  # fmt: skip
    GJ -= g * g * compliance
    return np.asarray(g * compliance)


def _of_law(law: Softening | Locking, s: Array) -> Array:
    return np.stack([_positive("EJ", "N m^2", law.EJ(s)), _positive("kappa", "1/m", law.kappa(s))], axis=1)


def _positive(name: str, unit: str, values: Array) -> Array:
    lowest = float(np.min(values))
    if not lowest > 0.0:
        raise ValueError(f"{name} must be > 0 {unit} everywhere along the rod, got {lowest}")
    return np.array(values)


OF_STRETCH = (Stretch, TwistStretch)


def can_stretch(rod: Rod) -> bool:
    """Whether a rod has a law of stretch."""
    return any(isinstance(law, Stretch) for law in rod.laws)


def needs_segments(rod: Rod) -> str:
    """What a rod does that is known to segments alone, or nothing."""
    if can_stretch(rod):
        return "can stretch"
    return "resists the rates of bending and twisting" if any(isinstance(law, Viscosity) for law in rod.laws) else ""


def without_stretch(rod: Rod) -> Rod:
    """The rod that cannot stretch, and else is the same."""
    return replace(rod, laws=tuple(law for law in rod.laws if not isinstance(law, OF_STRETCH)))


def about(elastic: Elasticity, index: int) -> Elasticity:
    """That of a turn about one principal axis, of a rod whose laws keep to it. None but K is of torsion."""
    if index == 2:
        elastic = elastic._replace(softening=elastic.softening[:0], locking=elastic.locking[:0])
    return elastic._replace(K=elastic.K[:, index, index].copy(), kappa0=elastic.kappa0[:, index].copy(),
                            viscosity=elastic.viscosity[:, index, index].copy())  # fmt: skip


def principal(elastic: Elasticity) -> Array:
    """EJ1, EJ2 and GJ3 (n, 3) of the rod that is not strained."""
    stiffnesses = np.array(np.diagonal(elastic.K, axis1=1, axis2=2))
    if len(elastic.softening):
        stiffnesses[:, :2] += elastic.softening[:, :1]
    return stiffnesses


def mean_bending(elastic: Elasticity) -> float:
    """The mean of EJ1 and EJ2 along the rod, the unit of stiffness."""
    return float(principal(elastic)[:, :2].mean())


def moments(elastic: Elasticity, kappa: Array) -> Array:
    """The moments q (n, 3) of curvatures kappa (n, 3), as `moment` has them."""
    strain = kappa - elastic.kappa0
    q = np.asarray(np.einsum("nij,nj->ni", elastic.K, strain))
    if len(elastic.softening) + len(elastic.locking):
        bend = np.linalg.norm(strain[:, :2], axis=1)
        _, secant, _ = _of_bend.py_func(elastic, slice(None), bend)  # type: ignore[attr-defined]
        q[:, :2] += secant[:, None] * strain[:, :2]
    return q


@kernel
def add_strain(elastic: Elasticity, j: int, q: Any, kappa: Array) -> None:
    """Add to kappa (3,) what a small moment q adds, by Cramer's rule. (LAPACK rounds as the host's CPU has it.)"""
    a, b, c = tangent(elastic, j, (kappa[0], kappa[1], kappa[2]))
    bc, ca, ab = vector_product(b, c), vector_product(c, a), vector_product(a, b)
    whole = dot(a, bc)
    for k in range(3):
        kappa[k] += (q[0] * bc[k] + q[1] * ca[k] + q[2] * ab[k]) / whole


@inlined
def is_linear(elastic: Elasticity) -> bool:
    """Whether q is linear in kappa at a given tension."""
    return len(elastic.softening) == 0 and len(elastic.locking) == 0


@inner
def _of_bend(elastic: Elasticity, j: Any, bend: Any) -> Any:
    """Of the laws of the bend b: the energy U(b), U'/b and U''. Of one joint, or in numpy of all."""
    energy, secant, along = 0.0, 0.0, 0.0
    if len(elastic.softening) > 0:
        EJ, ratio = elastic.softening[j, 0], bend / elastic.softening[j, 1]
        root = np.sqrt(1.0 + ratio * ratio)
        energy, secant, along = EJ * bend * bend / (1.0 + root), EJ / root, EJ / root**3
    if len(elastic.locking) > 0:
        EJ, kappa = elastic.locking[j, 0], elastic.locking[j, 1]
        beyond = np.maximum(bend - kappa, 0.0)
        energy, secant = energy + 0.5 * EJ * beyond * beyond, secant + EJ * beyond / (beyond + kappa)
        along = along + EJ * (bend > kappa)
    return energy, secant, along


@inner
def _bend(strain: Any) -> float:
    return sqrt(strain[0] * strain[0] + strain[1] * strain[1])


@inner
def moment(elastic: Elasticity, j: int, kappa: Any) -> Any:
    """q, K (kappa - kappa0) and what other laws add."""
    strain = minus(kappa, line(elastic.kappa0, j))
    q = transform(stiffness(elastic.K, j), strain)
    return q if is_linear(elastic) else plus(q, moment_beyond(elastic, j, strain))


@by_type
def moment_beyond(elastic: Elasticity, j: int, strain: Any) -> Any:
    """What q is more than K strain, of a rod where it is not linear in kappa."""
    if isinstance(strain, numba.types.Float):
        return lambda elastic, j, strain: _of_bend(elastic, j, abs(strain))[1] * strain
    return lambda elastic, j, strain: _moment_of_bend(elastic, j, strain)


@inner
def _moment_of_bend(elastic: Elasticity, j: int, strain: Any) -> Any:
    _, secant, _ = _of_bend(elastic, j, _bend(strain))
    return secant * strain[0], secant * strain[1], 0.0


@inlined
def moment_of(a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float, i: float,
              x: float, y: float, z: float) -> tuple[float, float, float]:  # fmt: skip
    """K strain, of the entries of K row by row: for what is computed eight abreast."""
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


@inner
def tangent(elastic: Elasticity, j: int, kappa: Any) -> Any:
    """dq / d kappa, symmetric."""
    K = stiffness(elastic.K, j)
    return K if is_linear(elastic) else _tangent_beyond(elastic, j, minus(kappa, line(elastic.kappa0, j)), K)


@by_type
def _tangent_beyond(elastic: Elasticity, j: int, strain: Any, K: Any) -> Any:
    """K and what laws of the bend add, U'/b across its direction and U'' along it."""
    if isinstance(strain, numba.types.Float):
        return lambda elastic, j, strain, K: K + _of_bend(elastic, j, abs(strain))[2]
    return lambda elastic, j, strain, K: add(K, _tangent_of_bend(elastic, j, strain))


@inner
def _tangent_of_bend(elastic: Elasticity, j: int, strain: Any) -> Any:
    bend = _bend(strain)
    _, secant, along = _of_bend(elastic, j, bend)
    if bend == 0.0:
        return (secant, 0.0, 0.0), (0.0, secant, 0.0), (0.0, 0.0, 0.0)
    x, y, more = strain[0] / bend, strain[1] / bend, along - secant
    return (secant + more * x * x, more * x * y, 0.0), (more * x * y, secant + more * y * y, 0.0), (0.0, 0.0, 0.0)


@by_type
def strain_energy(elastic: Elasticity, j: int, x: Any) -> Any:
    """Of bending and of torsion at a strain x: 1/2 x . K x, the torsional share being that of x3; what other laws add
    is of bending. About one axis their sum."""
    if isinstance(x, numba.types.Float):
        return lambda elastic, j, x: 0.5 * elastic.K[j] * x * x + _energy_of_bend(elastic, j, abs(x))
    return lambda elastic, j, x: _strain_energy(elastic, j, x)


@inner
def _energy_of_bend(elastic: Elasticity, j: int, bend: float) -> float:
    return 0.0 if is_linear(elastic) else float(_of_bend(elastic, j, bend)[0])


@inner
def _strain_energy(elastic: Elasticity, j: int, strain: Any) -> tuple[float, float]:
    q = transform(stiffness(elastic.K, j), strain)
    bending = 0.5 * (strain[0] * q[0] + strain[1] * q[1]) + _energy_of_bend(elastic, j, _bend(strain))
    return bending, 0.5 * strain[2] * q[2]


@inlined
def is_viscous(elastic: Elasticity) -> bool:
    """Whether the rod resists the rates of bending and twisting."""
    return len(elastic.viscosity) > 0


@inlined
def stretches(elastic: Elasticity) -> bool:
    """Whether the rod can stretch. What follows is asked for only where it can."""
    return len(elastic.compliance) > 0


@inner
def axial_strain(elastic: Elasticity, j: int, kappa: Any, N: float) -> float:
    """eps, at the curvature kappa and the tension N."""
    return float(elastic.compliance[j] * N - elastic.by_tension[j] * (kappa[2] - elastic.kappa0[j, 2]))


@inner
def axial_tangent(elastic: Elasticity, j: int) -> tuple[float, Any]:
    """d eps / dN, and dq / dN = - d eps / d kappa."""
    return elastic.compliance[j], (0.0, 0.0, elastic.by_tension[j])


@inner
def moment_of_tension(elastic: Elasticity, j: int, N: float) -> Any:
    """What a tension adds to q."""
    _, by_tension = axial_tangent(elastic, j)
    return times(N, by_tension)


@inner
def stretch_energy(elastic: Elasticity, j: int, N: float) -> float:
    """What the tension stores, 1/2 N^2 d eps / dN: all that U is more than the energies of bending and torsion."""
    return float(0.5 * elastic.compliance[j] * N * N)
