"""Kinds of scenes that come to rest, or nearly: hung, bent, brought together, wound."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.random import Generator

from stress.plausible.parts import GRAVITY, Drawn, Part, arc, case, curve, helix, log, ramp, straight, water
from validation.rods import trefoil

ANY = ("steel", "aluminium", "carbon", "glass fibre", "nylon", "polypropylene", "rubber")


def riser(rng: Generator) -> Part:
    """A pipe from the sea floor, held up by a float, in a current that is there at once."""
    d = Drawn(rng, ("steel", "nylon", "glass fibre"), (20.0, 300.0), (1e-3, 5e-3))
    pull = log(rng, 0.3, 3.0) * d.mass * 9.81 * d.L
    ends = "pin", {"preset": "free", "frame": "lab", "f3": pull}
    return case("riser", d.rod, straight(0, 0, 1), ends, log(rng, 20.0, 120.0), 60,
                fluid=water(rng, log(rng, 0.1, 1.0)), loads={"gravity": GRAVITY})  # fmt: skip


def cantilever(rng: Generator) -> Part:
    """A beam with a load at its tip, sudden or grown."""
    d = Drawn(rng, ANY, (0.1, 5.0), (2e-3, 2e-2))
    F, t_end = log(rng, 0.2, 5.0) * d.EJ / d.L**2, 6.0 * d.period
    load = F if rng.random() < 0.5 else ramp(0.0, 3.0 * d.period, F)
    damping = 0.0 if rng.random() < 0.4 else 1.0 / d.period
    return case("cantilever", d.rod, straight(0, 0, 1), ("clamp", {"preset": "free", "frame": "lab", "f1": load}),
                t_end, loads={"damping": damping})  # fmt: skip


def column(rng: Generator) -> Part:
    """A straight column between clamps or pins that are brought together: the first problem of a book on buckling."""
    d = Drawn(rng, ANY, (0.1, 3.0), (2e-3, 2e-2))
    preset = str(rng.choice(["clamp", "pin"]))
    moved = {"preset": preset, "x3": ramp(0.0, 20.0 * d.period, -log(rng, 0.02, 0.4) * d.L)}
    seed = {"s": 0.5 * d.L, "force": [1e-2 * d.EJ / d.L**2, 0.0, 0.0]}
    return case("column", d.rod, straight(0, 0, 1), (preset, moved), 30.0 * d.period,
                loads={"damping": 1.0 / d.period, "point": [seed]})  # fmt: skip


def mast(rng: Generator) -> Part:
    """A straight rod that stands or hangs between its ends under its own weight, and is pushed at its middle."""
    d = Drawn(rng, ANY, (0.1, 10.0), (3e-3, 2e-2))
    weight = d.mass * min(9.81, log(rng, 1.0, 15.0) * d.EJ / (d.mass * d.L**3))  # below that of its buckling, mostly
    push = {"s": 0.5 * d.L, "force": [ramp(0.0, 3.0 * d.period, log(rng, 0.1, 3.0) * d.EJ / d.L**2), 0.0, 0.0]}
    up = 1.0 if rng.random() < 0.5 else -1.0
    return case("mast", d.rod, straight(0, 0, up), (str(rng.choice(["clamp", "pin"])), "pin"), 8.0 * d.period,
                loads={"gravity": [0.0, 0.0, -weight / d.mass], "damping": log(rng, 0.2, 2.0) / d.period,
                       "point": [push]})  # fmt: skip


def sagging(rng: Generator) -> Part:
    """A cable between two pins, let go from an arc; or its equilibrium."""
    d = Drawn(rng, ("steel", "nylon", "polypropylene"), (1.0, 100.0), (1e-3, 5e-3))
    static = rng.random() < 0.5
    t_end = 1.0 if static else 6.0 * float(np.sqrt(d.L / 9.81))
    more: Part = {"analysis": "static"} if static else {}
    shape = curve(arc(d.L, log(rng, 0.8, 2.5)) @ np.diag([1.0, 1.0, 1.0])[:, [2, 1, 0]], a1=[0.0, 1.0, 0.0])
    return case("sagging", d.rod, shape, ("pin", "pin"), t_end, 1 if static else 40,
                loads={"gravity": GRAVITY, "damping": 0.0 if static else 0.5}, **more)  # fmt: skip


def coil(rng: Generator) -> Part:
    """A helical spring, at rest, or pulled at its end."""
    d = Drawn(rng, ("steel",), (0.5, 3.0), (1e-3, 3e-3))
    R = d.L / (2.0 * pi * log(rng, 3.0, 8.0))
    points, length = helix(R, 0.3 * R, d.L / (2.0 * pi * R))
    pull = 0.0 if rng.random() < 0.3 else log(rng, 0.02, 0.3) * d.EJ / R**2 * d.D / R
    end = {"preset": "free", "frame": "lab", "f3": ramp(0.0, 0.2, pull) if pull else 0.0}
    return case("coil", d.rod | {"length": length, "kappa0": "initial"}, curve(points), ("clamp", end), 0.5,
                loads={"damping": log(rng, 1.0, 10.0)})  # fmt: skip


def tape(rng: Generator) -> Part:
    """A flat strip that is bent by its weight and by a twist at its end."""
    d = Drawn(rng, ("steel", "nylon"), (0.2, 2.0), (2e-3, 5e-3))
    rod = {name: value for name, value in d.rod.items() if name not in ("youngs_modulus", "shear_modulus")}
    rod |= {"bending_stiffness": [d.EJ * log(rng, 20.0, 100.0), d.EJ], "torsional_stiffness": 1.5 * d.EJ}
    end = {"preset": "free", "theta3": ramp(0.0, 4.0 * d.period, log(rng, 0.3, 3.0))}
    return case("tape", rod, straight(1, 0, 0), ("clamp", end), 8.0 * d.period,
                loads={"gravity": [0.0, 0.0, -log(rng, 0.1, 2.0) * d.EJ / (d.mass * d.L**3)],
                       "damping": 1.0 / d.period})  # fmt: skip


def slack_twist(rng: Generator) -> Part:
    """A rod between clamps, twisted by some turns while they come together."""
    d = Drawn(rng, ANY, (0.2, 2.0), (3e-3, 2e-2))
    t_end = 40.0 * d.period
    end = {"preset": "clamp", "x3": ramp(0.0, 0.5 * t_end, -log(rng, 0.02, 0.15) * d.L),
           "theta3": ramp(0.0, 0.6 * t_end, log(rng, 3.0, 15.0))}  # fmt: skip
    seed = {"s": 0.4 * d.L, "force": [1e-3 * d.EJ / d.L**2, 0.0, 0.0]}
    return case("slack-twist", d.rod, straight(0, 0, 1), ("clamp", end), t_end, contact={},
                loads={"damping": 1.0 / d.period, "point": [seed]})  # fmt: skip


def plectoneme(rng: Generator) -> Part:
    """A rod that is pulled weakly and twisted until it winds around itself."""
    d = Drawn(rng, ("rubber", "silicone", "nylon"), (0.3, 2.0), (5e-3, 1.5e-2))
    t_end = 150.0 * d.period
    end = {"preset": "slider", "f3": log(rng, 10.0, 60.0) * d.EJ / d.L**2,
           "theta3": ramp(0.0, 0.7 * t_end, 2.0 * pi * log(rng, 4.0, 9.0))}  # fmt: skip
    seed = {"s": 0.5 * d.L, "force": [1e-3 * d.EJ / d.L**2, 0.0, 0.0]}
    more: Part = {} if rng.random() < 0.3 else {"contact": {}}
    return case("plectoneme", d.rod, straight(0, 0, 1), ("clamp", end), t_end,
                loads={"damping": 2.0 / d.period, "point": [seed]}, **more)  # fmt: skip


def dna(rng: Generator) -> Part:
    """Some hundred nanometres of DNA in water, pulled by a piconewton or less and twisted."""
    L, EJ = log(rng, 1e-7, 6e-7), 2.07e-28
    rod = {"length": L, "diameter": 2e-9, "bending_stiffness": EJ, "torsional_stiffness": 4e-28, "density": 1700.0}
    mass = 1700.0 * pi * 1e-18
    drag = 4.0 * pi * 1e-3 / np.log(L / 2e-9) / mass  # 1/s, of water
    t_end = log(rng, 1.0, 5.0) * drag * mass * L**4 / EJ * 0.01
    end = {"preset": "slider", "f3": log(rng, 5e-14, 1e-12),
           "theta3": ramp(0.0, 0.6 * t_end, 2.0 * pi * log(rng, 0.5, 4.0))}  # fmt: skip
    seed = {"s": 0.5 * L, "force": [1e-3 * EJ / L**2, 0.0, 0.0]}
    return case("dna", rod, straight(0, 0, 1), ("clamp", end), t_end, contact={},
                loads={"damping": float(drag), "point": [seed]})  # fmt: skip


def bent_and_pushed(rng: Generator) -> Part:
    """An arc between pins that is pushed through by a force on its middle: damped."""
    d = Drawn(rng, ("steel", "carbon", "nylon"), (0.1, 1.0), (3e-3, 1e-2))
    shape = curve(arc(d.L, log(rng, 0.6, 1.5)), a1=[0.0, 1.0, 0.0])
    push = {"s": 0.45 * d.L, "force": [ramp(0.0, 10.0 * d.period, log(rng, 5.0, 40.0) * d.EJ / d.L**2), 0.0, 0.0]}
    return case("bent-and-pushed", d.rod | {"kappa0": "initial"}, shape, ("pin", "pin"), 15.0 * d.period,
                loads={"damping": 2.0 / d.period, "point": [push]})  # fmt: skip


def loop(rng: Generator) -> Part:
    """A ring that is held at one point and closed by a second clamp, under its weight."""
    d = Drawn(rng, ("steel", "nylon", "rubber"), (0.3, 2.0), (2e-3, 1e-2))
    shape = curve(arc(d.L, 2.0 * pi * 0.98, 201), a1=[0.0, 1.0, 0.0])
    return case("loop", d.rod, shape, ("clamp", "clamp"), 8.0 * d.period,
                loads={"gravity": [0.0, 0.0, -log(rng, 0.5, 10.0) * d.EJ / (d.mass * d.L**3)],
                       "damping": 1.0 / d.period})  # fmt: skip


def knot(rng: Generator) -> Part:
    """A rod with an overhand knot that is pulled tight by a force, or by its end."""
    d = Drawn(rng, ("steel", "nylon", "polypropylene", "rubber"), (0.1, 5.0), (2e-3, 1e-2))
    t_end = 20.0 * d.period
    force = {"f3": ramp(0.0, 0.7 * t_end, log(rng, 40.0, 400.0) * d.EJ / d.L**2)}
    moved = {"x3": ramp(0.0, 0.7 * t_end, log(rng, 0.05, 0.2) * d.L)}
    pulled = force if rng.random() < 0.5 else moved
    return case("knot", d.rod, curve(trefoil(d.L, log(rng, 0.5, 0.7))), ("clamp", {"preset": "slider"} | pulled), t_end,
                contact={}, loads={"damping": log(rng, 5.0, 50.0) / d.period})  # fmt: skip


def stepped(rng: Generator) -> Part:
    """A turned shaft or a fishing rod's blank, thinner from step to step, with a load at its tip: at rest or damped."""
    d = Drawn(rng, ("steel", "aluminium", "carbon", "nylon"), (0.1, 3.0), (4e-3, 2e-2))
    thick = [d.D]
    for _ in range(int(rng.integers(1, 4))):
        thick.append(thick[-1] * log(rng, 0.5, 0.9))
    steps = np.sort(rng.uniform(0.15, 0.85, len(thick) - 1)) * d.L
    s = [0.0, *np.ravel(np.column_stack([steps, steps + 1e-3 * d.L])).tolist(), d.L]
    rod = d.rod | {"diameter": {"s": s, "value": np.repeat(thick, 2).tolist(), "interpolation": "linear"}}
    unit = d.E * pi * thick[-1] ** 4 / 64.0 / d.L**2
    force = [ramp(0.0, 6.0 * d.period, log(rng, 0.3, 3.0) * unit), log(rng, 0.01, 0.3) * unit, 0.0]
    pull = {"s": d.L, "force": force}
    more: Part = {"analysis": "static"} if rng.random() < 0.4 else {}
    return case("stepped", rod, straight(0, 0, 1), ("clamp", "free"), 10.0 * d.period, 20,
                loads={"damping": 2.0 / d.period, "point": [pull]}, **more)  # fmt: skip


def hooked(rng: Generator) -> Part:
    """A wire that is bent by nature in one part, as a catheter's tip, drawn straight and let go, or pulled: at rest."""
    d = Drawn(rng, ("steel", "nylon", "polypropylene", "silicone"), (0.05, 1.0), (2e-3, 1e-2))
    start, length = rng.uniform(0.1, 0.6) * d.L, rng.uniform(0.15, 0.35) * d.L
    s = [0.0, start, start + 2e-3 * d.L, start + length, start + length + 2e-3 * d.L, d.L]
    bent = log(rng, 0.5, 3.0) / length
    natural = {"s": s, "value": [0.0, 0.0, bent, bent, 0.0, 0.0], "interpolation": "linear"}
    point = {"s": d.L, "force": [0.0, 0.0, ramp(0.0, 1.0, log(rng, 0.5, 10.0) * d.EJ / d.L**2)]}
    loads: Part = {"point": [point]} if rng.random() < 0.5 else {}
    return case("hooked", d.rod | {"kappa0": [0.0, natural, 0.0]}, straight(0, 0, 1), ("clamp", "free"), 1.0, 10,
                analysis="static", loads=loads)  # fmt: skip


KINDS = (riser, cantilever, column, mast, sagging, coil, tape, slack_twist, plectoneme, knot, dna, bent_and_pushed,
         loop, stepped, hooked)
