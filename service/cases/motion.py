"""How a rod begins to move: what is held back, and what is faster than anything in a rod."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.quantities import ScheduleTable
from service.cases.size import tables_in
from solver import Scene
from solver.physics.elasticity import Stretch
from solver.scene.layout import nodes_at_rest

PLACES = 401
JERK = 1e-3
"""Part of the largest speed that an end which is held may have at first: that of a rod which begins to swing."""
AT_ONCE = 0.1
"""Part of its largest speed with which an end may begin to move a rod that is at rest."""


def motion_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What is wrong with how the rod, or an end of it, is moved."""
    return [*_held_back(scene), *_jerked(scene), *_too_fast(spec, scene)]


def _held_back(scene: Scene) -> Iterator[FieldError]:
    """A rod that begins to move as a whole while an end of it stays where it is, or as it is turned."""
    spin, moves = np.array(scene.initial.angular_velocity), _moves(scene)
    speeds = np.linalg.norm(moves, axis=1)
    field = "angular_velocity" if spin.any() else "velocity"
    for at, name, end in ((0, "start", scene.start), (-1, "end", scene.end)):
        stays, as_turned = (all(c[0].kind != "load" and c[0].curve.is_zero for c in components)
                            for components in (end.translation, end.rotation))  # fmt: skip
        if (stays and speeds[at] > JERK * speeds.max()) or (as_turned and spin.any()):
            held = "where" if stays else "as"
            rule = f"is of the whole rod, whose {name} is held {held} it is: it begins with a jerk"
            if spin.any() and not as_turned:
                still = ", ".join(f"{v:.5g}" for v in np.array(scene.initial.velocity) - moves[at] + 0.0)
                rule += f"; it turns about its {name} with a velocity of [{still}]"
            yield FieldError(f"/initial/{field}", float(np.linalg.norm(getattr(scene.initial, field))), rule)


def _jerked(scene: Scene) -> Iterator[FieldError]:
    """An end that begins to move at once, where the rod is at rest."""
    if scene.at_rest or any(scene.initial.velocity) or any(scene.initial.angular_velocity):
        return
    for name, end in (("start", scene.start), ("end", scene.end)):
        conditions = [component[0] for component in end.translation]
        last = max((t for condition in conditions for t in condition.curve.corners), default=scene.t_end)
        times = np.linspace(0.0, min(last, scene.t_end), PLACES).tolist()
        speeds = [{"rate": condition.curve.value, "position": condition.curve.derivative}.get(condition.kind)
                  for condition in conditions]  # fmt: skip
        largest = max((abs(speed(t)) for speed in speeds if speed for t in times), default=0.0)
        for i, (condition, speed) in enumerate(zip(conditions, speeds, strict=True)):
            first = speed(0.0) if speed else 0.0
            if abs(first) > AT_ONCE * largest:
                rule = (f"begins at {first:.3g} m/s, and the rod is at rest: it begins with a jerk; let it begin at 0 "
                        "and gain speed (smoothstep), or give the rod its initial.velocity")  # fmt: skip
                yield FieldError(f"/ends/{name}/{'v' if condition.kind == 'rate' else 'x'}{i + 1}", None, rule)


def _moves(scene: Scene) -> Any:
    """The velocities (n, 3) of places along the rod at t = 0."""
    s = np.linspace(0.0, scene.rod.length, PLACES)
    r, weights = nodes_at_rest(scene.initial, s)[0], scene.rod.mass(s) + 0.0 * s
    weights[[0, -1]] *= 0.5
    arms = r - np.average(r, axis=0, weights=weights)
    return np.array(scene.initial.velocity) + np.cross(np.array(scene.initial.angular_velocity), arms)


def _too_fast(spec: CaseSpec, scene: Scene) -> Iterator[FieldError]:
    """What moves faster than a push runs along the rod, sqrt(EA / m), EA being that of a solid section where it is not
    given: an end, or the rod itself as it begins. In a static analysis nothing has a speed."""
    if scene.at_rest:
        return
    s = np.linspace(0.0, scene.rod.length, 11)
    EA = [law.EA(s) for law in scene.rod.laws if isinstance(law, Stretch)]
    EA = EA or [16.0 * profile(s) / scene.rod.diameter(s) ** 2 for profile in scene.rod.stiffness[:2]]
    sound = float(np.sqrt(np.max(np.array(EA) / scene.rod.mass(s))))
    speeds = {where: float(np.max(np.abs(np.diff(table.value) / np.diff(table.t))))
              for where, table in tables_in(spec.ends, "/ends")
              if where.rpartition("/")[2] in ("x1", "x2", "x3") and isinstance(table, ScheduleTable)}  # fmt: skip
    if any(scene.initial.angular_velocity):
        swung = np.cross(np.array(scene.initial.angular_velocity), np.diff(nodes_at_rest(scene.initial, s)[0], axis=0))
        speeds["/initial/angular_velocity"] = 0.5 * float(np.linalg.norm(swung, axis=1).sum())
    for where, speed in speeds.items():
        if speed > sound:
            rule = f"moves at {speed:.3g} m/s, faster than sound runs along the rod, {sound:.3g} m/s"
            yield FieldError(where, speed, rule)
