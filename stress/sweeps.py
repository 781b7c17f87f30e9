"""The sweeps and the two-parameter maps: base scenes with one or two things changed over many decades."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

from service.cases import apply_settings, estimate, parse_case
from stress.ending import Task
from stress.scenes import SCENES, Case, twist

METHODS = ("box", "staggered")
MOST_STEPS = 150
"""Steps of dt_max that a run lasts at the most: t_end is cut to it."""
BUDGET = 20.0
"""CPU seconds of a run."""
ALLOWANCE = 6
"""How many times as many steps a run may take as it would with dt_max."""

Change = Callable[[Any], dict[str, Any]]
"""From a value to settings by dotted key."""


@dataclass(frozen=True)
class Axis:
    """What is varied: its name with the unit, its values, and the settings that a value makes."""

    name: str
    values: tuple[Any, ...]
    change: Change


@dataclass(frozen=True)
class Sweep:
    """A base scene along one axis, or over two (a map): `across` is the second one."""

    name: str
    scene: str
    along: Axis
    across: Axis | None = None
    methods: tuple[str, ...] = METHODS

    def tasks(self) -> Iterator[Task]:
        """Every run of it; `at` is the method and the values."""
        for method, x, y in product(self.methods, self.along.values, self.across.values if self.across else (None,)):
            settings = self.along.change(x) | (self.across.change(y) if self.across else {})
            if method != "static":
                settings["numerics.method"] = method
            case = shortened(apply_settings(SCENES[self.scene](), settings))
            yield Task(self.name, (method, x, y), case, ALLOWANCE * steps_of(case), BUDGET)


def shortened(case: Case) -> Case:
    """The case, ending after `MOST_STEPS` steps of dt_max if that is earlier, with as many frames."""
    if case.get("analysis") == "static":
        return case
    longest = MOST_STEPS * case["numerics"]["dt_max"]
    part = min(1.0, longest / case["t_end"])
    return apply_settings(case, {"t_end": part * case["t_end"], "output.interval": part * case["output"]["interval"]})


def steps_of(case: Case) -> int:
    """Steps that a case takes with dt_max or a frame a step, and those of a start."""
    return estimate(parse_case(case)).steps + 40


def plain(key: str, factor: float = 1.0) -> Change:
    """The value itself, in another unit, at one key."""
    return lambda value: {key: value if factor == 1.0 else factor * value}


def _thickness(mm: float) -> dict[str, Any]:
    """A diameter, and contact that suits it."""
    D = 1e-3 * mm
    return {"rod.diameter": D, "contact.cutoff": max(0.012, 3.0 * D), "contact.skip": max(0.04, 6.0 * D)}


def _torsion(ratio: float) -> dict[str, Any]:
    """GJ3 / EJ."""
    return {"rod.shear_modulus": 0.5 * 1.25e7 * ratio}


def _anisotropy(ratio: float) -> dict[str, Any]:
    """EJ2 / EJ1."""
    return {"rod.youngs_modulus": None, "rod.bending_stiffness": [6.136e-3, 6.136e-3 * ratio]}


def _soft_half(ratio: float) -> dict[str, Any]:
    """E of the end's half over that of the start's, within 5 % of the length."""
    table = {"s": [0.475, 0.525], "value": [6.136e-3, 6.136e-3 * ratio], "interpolation": "smoothstep"}
    return {"rod.youngs_modulus": None, "rod.bending_stiffness": table}


def _jump(end: str) -> dict[str, Any]:
    """An end that is driven without mercy: see `JUMPS`."""
    return JUMPS[end]


def _table(times: list[float], values: list[float], interpolation: str = "linear") -> dict[str, Any]:
    return {"t": times, "value": values, "interpolation": interpolation}


JUMPS: dict[str, dict[str, Any]] = {
    "omega3 at once": {"ends.start.omega3": -16.0},
    "omega3 reversed in 1 us": {"ends.start.omega3": _table([0.0, 0.1, 1.0, 1.000001], [0.0, -16.0, -16.0, 16.0])},
    "theta3 by a turn in 1 ms": {"ends.start": {"preset": "clamp", "theta3": _table([0.5, 0.501], [0.0, 6.28])}},
    "theta1 by 1 rad in 1 ms": {"ends.start": {"preset": "clamp", "theta1": _table([0.5, 0.501], [0.0, 1.0])}},
    "v1 at once": {"ends.start": {"preset": "clamp", "v1": 0.5}},
    "v3 at once": {"ends.end": {"preset": "clamp", "v3": -0.2}},
    "x1 by 0.2 m in 1 ms": {"ends.start": {"preset": "clamp", "x1": _table([0.5, 0.501], [0.0, 0.2])}},
    "f3 by 100 N in 1 ms": {"ends.end": {"preset": "slider", "f3": _table([0.5, 0.501], [0.0, 100.0])}},
    "f3 at once": {"ends.end": {"preset": "slider", "f3": 1.0}},
    "q3 at once": {"ends.start": {"preset": "clamp", "q3": 0.05}},
    "let go": {"ends.end": {"preset": "slider", "switches": [{"at": 1.5, **dict.fromkeys(
        ("f1", "f2", "f3", "q1", "q2", "q3"), 0.0)}]}},
    "caught": {"ends.end": {"preset": "slider", "switches": [{"at": 1.5, "v3": 0.0}]}},
    "caught within 1 ms": {"ends.end": {"preset": "slider", "switches": [{"at": 1.5, "v3": {"stop_within": 1e-3}}]}},
}  # fmt: skip

DT = (1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0)
MILLIMETRES = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 50.0)
RATIOS = (1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3)

dt = Axis("dt_max (s)", DT, plain("numerics.dt_max"))
N = Axis("intervals", (10, 20, 50, 100, 200, 500, 1000, 2000, 5000), plain("numerics.intervals"))
rho_inf = Axis("rho_inf", (0.0, 0.25, 0.5, 0.75, 0.9, 1.0), plain("numerics.rho_inf"))
D = Axis("diameter (mm)", MILLIMETRES, _thickness)
D_bare = Axis("diameter (mm)", MILLIMETRES, plain("rod.diameter", 1e-3))
torsion = Axis("GJ / EJ", RATIOS, _torsion)
anisotropy = Axis("EJ2 / EJ1", RATIOS, _anisotropy)
soft_half = Axis("EJ of one half / of the other", RATIOS, _soft_half)
twist_rate = Axis("twist rate (rad/s)", (0.0, 0.1, 1.0, 10.0, 30.0, 100.0, 300.0, 1000.0),
                  lambda rate: {"ends.start.omega3": twist(-rate)})  # fmt: skip
seed = Axis("seed force (N/m)", (0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4),
            lambda force: {"loads.distributed.0.force": [force, 0.0, 0.0]})  # fmt: skip
jumps = Axis("an end that jumps", tuple(JUMPS), _jump)
drag = Axis("normal drag coefficient", (0.0, 1e-3, 0.1, 1.0, 10.0, 100.0, 1e3), plain("fluid.drag_normal"))
damping = Axis("viscous damping (1/s)", (0.0, 1e-2, 1.0, 100.0, 1e4), plain("loads.damping"))
k1 = Axis("k1 (m^4/s^2)", (1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4), plain("contact.k1"))
k2 = Axis("k2", (0.5, 1.0, 2.0, 3.0, 4.0, 6.0), plain("contact.k2"))
k3 = Axis("k3", (0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1), plain("contact.k3"))
loop_D = Axis("diameter (mm)", (0.5, 1.0, 2.0, 4.0, 6.0, 8.0), plain("rod.diameter", 1e-3))
load = Axis("gravity (m/s^2)", (0.0, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4),
            lambda g: {"loads.gravity": [-g, 0.0, 0.0]})  # fmt: skip
turn = Axis("turn of the end (rad)", (0.1, 1.0, 3.0, 6.0, 12.0, 30.0),
            lambda angle: {"ends.end.theta3": _table([0.0, 1.0], [0.0, angle])})  # fmt: skip
coarse_N = Axis("intervals", (10, 20, 50, 100, 200), plain("numerics.intervals"))

STATIC = ("static",)
SWEEPS = (
    Sweep("dt", "cable", dt), Sweep("N", "cable", N), Sweep("rho_inf", "cable", rho_inf, methods=("box",)),
    Sweep("D", "cable", D), Sweep("GJ / EJ", "cable", torsion), Sweep("EJ2 / EJ1", "cable", anisotropy),
    Sweep("soft half", "cable", soft_half), Sweep("twist rate", "cable", twist_rate),
    Sweep("seed force", "cable", seed),
    Sweep("end jumps", "cable", jumps), Sweep("drag", "cable", drag), Sweep("damping", "cable", damping),
    Sweep("k1", "loop", k1), Sweep("k2", "loop", k2), Sweep("k3", "loop", k3), Sweep("N, contact", "loop", N),
    Sweep("static N", "arch", N, methods=STATIC), Sweep("static D", "bent", D_bare, methods=STATIC),
    Sweep("static GJ / EJ", "arch", torsion, methods=STATIC),
    Sweep("static EJ2 / EJ1", "arch", anisotropy, methods=STATIC),
    Sweep("static soft half", "bent", soft_half, methods=STATIC),
)  # fmt: skip
MAPS = (
    Sweep("dt and N", "swing", dt, N), Sweep("dt and N, buckling", "cable", dt, coarse_N),
    Sweep("dt and D", "swing", dt, D_bare), Sweep("dt and GJ / EJ, buckling", "cable", dt, torsion),
    Sweep("dt and stiffness of one half", "swing", dt, soft_half),
    Sweep("dt and rho_inf, buckling", "cable", dt, rho_inf, methods=("box",)),
    Sweep("dt and twist rate", "cable", dt, twist_rate), Sweep("dt and seed force", "cable", dt, seed),
    Sweep("k1 and D, contact", "loop", k1, loop_D), Sweep("dt and k1, contact", "loop", dt, k1),
    Sweep("N and k1, contact", "loop", coarse_N, k1),
    Sweep("load and D, statics", "bent", load, D_bare, methods=STATIC),
    Sweep("turn and N, statics", "arch", turn, coarse_N, methods=STATIC),
)  # fmt: skip
