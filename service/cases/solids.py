"""Floors and obstacles, and a rod that touches itself: what they would do to it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from service.cases.case import CaseSpec
from service.cases.errors import FieldError
from service.cases.extents import forces, widest
from solver import Scene
from solver.arrays import Array
from solver.physics.loads.solids import Floor, Given, Obstacle
from solver.physics.section import sample
from solver.scene.layout import nodes_at_rest

SOFT, HARD = 10.0, 0.1
"""Of its diameter, by how much its weight may press a rod in; and by how much where a floor is hard."""
DRAWN_IN = 0.2
"""Of its radius, by how much a pull may draw a rod into an obstacle: beyond the middle it is pushed out on the other
side."""
BESIDE, WITHIN = 8.0, 0.9
"""In D: how far along the rod places are neighbours; and how near others overlap."""
PLACES, NEIGHBOURS = 161, 3
"""Along a rod that may lie across itself; and how many links apart those are that cross for their bend alone."""


def touching_of(spec: CaseSpec, scene: Scene) -> list[FieldError]:
    """What is wrong with what the rod touches."""
    return [*_obstacles(spec), *_begins_inside(scene), *_sinks(scene), *_is_drawn_in(scene),
            *_friction_at_rest(spec), *_touches_itself(scene), *_lies_across_itself(scene)]  # fmt: skip


def solids_of(scene: Scene) -> Iterator[tuple[str, Given]]:
    """Floor and obstacles, with their pointers."""
    count = 0
    for load in scene.loads:
        if isinstance(load, Given):
            yield "/loads/floor" if isinstance(load, Floor) else f"/loads/obstacles/{count}", load
            count += not isinstance(load, Floor)


def _obstacles(spec: CaseSpec) -> Iterator[FieldError]:
    """An obstacle that nodes may pass on both sides of."""
    intervals = spec.numerics.intervals
    if intervals is None or not spec.loads.obstacles:
        return
    interval = spec.rod.length / intervals
    smallest = min(range(len(spec.loads.obstacles)), key=lambda i: spec.loads.obstacles[i].radius)
    radius = spec.loads.obstacles[smallest].radius
    if interval > radius:
        rule = (f"leave {interval:.3g} m from node to node, more than the radius of {radius:.3g} m of "
                f"/loads/obstacles/{smallest}, which could pass between them")
        yield FieldError("/numerics/intervals", intervals, rule)


def _begins_inside(scene: Scene) -> Iterator[FieldError]:
    """A rod that begins so deep in something solid that it will be thrown out."""
    r, _, _ = nodes_at_rest(scene.initial, np.linspace(0.0, scene.rod.length, 201))
    for where, solid in solids_of(scene):
        deepest = float(np.max(solid.depth(r)))
        if deepest > widest(scene):
            rule = f"has the rod in it at t = 0, by {deepest:.3g} m: it would throw the rod out"
            yield FieldError(where, None, rule)


def _sinks(scene: Scene) -> Iterator[FieldError]:
    """A floor so soft that the rod's weight alone would press it in by far more than the rod is thick."""
    s = np.linspace(0.0, scene.rod.length, 201)
    section = sample(scene.rod, s)
    mass = section.mass - (scene.fluid.density * section.area if scene.fluid else 0.0)
    for where, solid in solids_of(scene):
        pressed = -float(np.dot(scene.gravity, solid.up)) if isinstance(solid, Floor) else 0.0
        depth = float(np.mean(mass)) * pressed / solid.stiffness
        if depth > SOFT * widest(scene):
            enough = solid.stiffness * depth / (HARD * widest(scene))
            rule = (f"is so small that the rod's weight presses it in by {depth:.2g} m, {depth / widest(scene):.2g} "
                    f"times its diameter: {enough:.1g} N/m² would be hard")  # fmt: skip
            yield FieldError(f"{where}/stiffness", solid.stiffness, rule)


def _is_drawn_in(scene: Scene) -> Iterator[FieldError]:
    """An obstacle so soft that a rod which is pulled over it with the force T, as deep as T / (R k), may cut it."""
    pull = max(forces(scene).values(), default=0.0)
    for where, solid in solids_of(scene):
        if isinstance(solid, Obstacle) and pull > DRAWN_IN * solid.radius**2 * solid.stiffness:
            depth, enough = pull / (solid.radius * solid.stiffness), pull / (solid.radius * widest(scene))
            rule = (f"is so small that a pull of {pull:.2g} N may draw the rod {depth:.2g} m into it, whose radius is "
                    f"{solid.radius:.2g} m: with {enough:.1g} N/m² it is drawn in by its diameter")  # fmt: skip
            yield FieldError(f"{where}/stiffness", solid.stiffness, rule)


def _friction_at_rest(spec: CaseSpec) -> Iterator[FieldError]:
    if spec.analysis != "static":
        return
    solids = [("/loads/obstacles/" + str(i), obstacle) for i, obstacle in enumerate(spec.loads.obstacles)]
    for where, solid in [("/loads/floor", spec.loads.floor), *solids]:
        if solid is not None and solid.friction:
            rule = "counts for nothing in a static analysis: friction needs a motion to act against"
            yield FieldError(f"{where}/friction", solid.friction, rule)


def _touches_itself(scene: Scene) -> Iterator[FieldError]:
    """With contact: a shape that begins within itself."""
    if scene.contact is None:
        return
    s = np.linspace(0.0, scene.rod.length, 201)
    r, _, _ = nodes_at_rest(scene.initial, s)
    D, along = float(np.min(scene.rod.diameter(s))), np.abs(s[:, None] - s)
    closed = float(np.linalg.norm(r[-1] - r[0])) < D  # a ring: its ends are neighbours
    along = np.minimum(along, scene.rod.length - along) if closed else along
    apart = np.linalg.norm(r[:, None] - r, axis=2)
    apart[along < max(BESIDE * D, 2.0 * s[1])] = np.inf
    one, other = np.unravel_index(int(np.argmin(apart)), apart.shape)
    if apart[one, other] < WITHIN * D:
        rule = (f"lays the places at s = {s[one]:.3g} and {s[other]:.3g} m nearer to each other than the diameter, "
                f"{D:.3g} m: with contact the rod must not begin within itself")  # fmt: skip
        yield FieldError("/initial", float(f"{apart[one, other]:.6g}"), rule)


def _lies_across_itself(scene: Scene) -> Iterator[FieldError]:
    """Without contact: a loop or a knot that is under stress, as one that is pulled, or bent by hand and let go."""
    s = np.linspace(0.0, scene.rod.length, PLACES)
    if scene.contact is not None or any(np.any(kappa(s)) for kappa in scene.rod.kappa0[:2]):
        return
    r, _, _ = nodes_at_rest(scene.initial, s)
    if many := _crossings(r):
        places = f"{many} places" if many > 1 else "a place"
        rule = f"is not given, but the rod lies across itself in {places} at first: it would pass through itself"
        yield FieldError("/contact", None, rule)


def _crossings(r: Array) -> int:
    """How often a polygon (n, 3) crosses itself in the plane that it is nearest to; neighbours do not count."""
    arms = r - r.mean(axis=0)
    x, y = np.linalg.svd(arms, full_matrices=False)[2][:2] @ arms.T

    def apart(i: Any, j: Any) -> Any:
        """Whether the ends of links j lie on two sides of the line along links i."""
        dx, dy = x[i + 1] - x[i], y[i + 1] - y[i]
        one, other = (dx * (y[k] - y[i]) - dy * (x[k] - x[i]) for k in (j, j + 1))
        return one * other < 0.0

    i, j = np.triu_indices(len(r) - 1, NEIGHBOURS)
    ring = j - i > len(r) - 1 - NEIGHBOURS
    return int(np.sum(apart(i, j) & apart(j, i) & ~ring))
