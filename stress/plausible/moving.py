"""Kinds of scenes that go on moving: towed, whirled, dropped, let go, shaken."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numpy.random import Generator

from stress.plausible.parts import (
    GRAVITY,
    MATERIALS,
    Drawn,
    Part,
    arc,
    case,
    curve,
    harmonic,
    log,
    ramp,
    straight,
    water,
)

ANY = ("steel", "carbon", "glass fibre", "nylon", "rubber")
LIMP = ("silicone", "rubber", "polypropylene")


def towed(rng: Generator) -> Part:
    """A cable that is towed through the sea from rest."""
    d = Drawn(rng, ("steel", "nylon", "polypropylene"), (10.0, 200.0), (1e-3, 5e-3))
    t_end = log(rng, 20.0, 120.0)
    ship = {"preset": "pin", "frame": "lab", "v1": ramp(0.0, 0.3 * t_end, log(rng, 0.3, 3.0))}
    return case("towed", d.rod, straight(0, 0, -1), (ship, "free"), t_end, 60, fluid=water(rng),
                loads={"gravity": GRAVITY})  # fmt: skip


def umbilical(rng: Generator) -> Part:
    """A cable under a ship that heaves."""
    d = Drawn(rng, ("steel", "nylon"), (20.0, 120.0), (5e-4, 2e-3))
    period = log(rng, 5.0, 14.0)
    ship = {"preset": "pin", "frame": "lab", "x3": harmonic(log(rng, 0.2, 2.0), period, 4.0 * period)}
    return case("umbilical", d.rod, straight(0, 0, -1), (ship, "free"), 4.0 * period, 60,
                fluid=water(rng, log(rng, 0.1, 0.8)), loads={"gravity": GRAVITY})  # fmt: skip


def mooring(rng: Generator) -> Part:
    """A chain from its anchor along the sea floor and up to a buoy that heaves and sways."""
    D, height = log(rng, 0.02, 0.12), log(rng, 20.0, 200.0)
    a = height * log(rng, 0.1, 1.5)  # of its catenary: horizontal tension over weight per length
    hanging = sqrt(height**2 + 2.0 * height * a)
    L, mass = hanging / rng.uniform(0.4, 0.9), 2e4 * D**2
    s = np.linspace(0.0, L, 401)
    up = np.maximum(s - (L - hanging), 0.0)
    points = np.stack([s - up + a * np.arcsinh(up / a), 0.0 * s, np.sqrt(a**2 + up**2) - a], axis=1)
    EJ, period = 1e-3 * MATERIALS["steel"][0] * pi * D**4 / 64.0, log(rng, 6.0, 14.0)
    rod = {"length": L, "diameter": D, "bending_stiffness": EJ, "torsional_stiffness": EJ,
           "axial_stiffness": 8.5e10 * D**2, "mass_per_length": mass}  # fmt: skip
    buoy = {"preset": "pin", "frame": "lab", "x1": harmonic(log(rng, 0.1, 2.0), period, 4.0 * period),
            "x3": harmonic(log(rng, 0.2, 3.0), period, 4.0 * period)}  # fmt: skip
    floor = {"stiffness": mass * 9.81 / (0.05 * D), "friction": log(rng, 0.2, 0.8)}
    return case("mooring", rod, curve(points, a1=[0.0, 1.0, 0.0]), ("pin", buoy), 4.0 * period, 60, fluid=water(rng),
                loads={"gravity": GRAVITY, "floor": floor})  # fmt: skip


def deep_sea(rng: Generator) -> Part:
    """A kilometre of steel below a ship that sets off."""
    d = Drawn(rng, ("steel",), (500.0, 2000.0), (3e-5, 1e-4))
    t_end = log(rng, 60.0, 300.0)
    ship = {"preset": "pin", "frame": "lab", "v1": ramp(0.0, 0.2 * t_end, log(rng, 0.3, 2.0))}
    return case("deep-sea", d.rod, straight(0, 0, -1), (ship, "free"), t_end, 60, fluid=water(rng),
                loads={"gravity": GRAVITY})  # fmt: skip


def whirled(rng: Generator) -> Part:
    """A line that hangs from a hand that goes round in a circle."""
    d = Drawn(rng, ("nylon", "rubber", "polypropylene"), (0.3, 3.0), (2e-3, 8e-3))
    period = log(rng, 0.6, 2.0) * 2.0 * pi * sqrt(d.L / 9.81)
    radius, t_end = log(rng, 0.03, 0.15) * d.L, 4.0 * period
    x, y = harmonic(radius, period, t_end), harmonic(radius, period, t_end)
    y["value"] = [y["value"][0], *y["value"][6:], *[y["value"][-1]] * 5]  # a quarter of a period later, about
    hand = {"preset": "pin", "frame": "lab", "x1": x, "x2": y}
    return case("whirled", d.rod, straight(0, 0, -1), (hand, "free"), t_end, 60,
                loads={"gravity": GRAVITY, "damping": log(rng, 0.05, 1.0)})  # fmt: skip


def dropped(rng: Generator) -> Part:
    """A bar that falls on a floor."""
    d = Drawn(rng, ("steel", "nylon", "rubber"), (0.2, 2.0), (5e-3, 2e-2))
    tilt, height = log(rng, 0.02, 0.5), log(rng, 0.05, 0.5)
    shape = straight(1, 0, tilt) | {"origin": [0.0, 0.0, height]}
    floor = {"stiffness": d.mass * 9.81 / (0.02 * d.D), "friction": log(rng, 0.05, 0.5)}
    return case("dropped", d.rod, shape, ("free", "free"), 3.0 * sqrt(2.0 * height / 9.81),
                loads={"gravity": GRAVITY, "floor": floor, "damping": log(rng, 0.5, 5.0)})  # fmt: skip


def suture(rng: Generator) -> Part:
    """A thread whose end is taken along by an instrument, which comes to rest."""
    d = Drawn(rng, ("nylon", "polypropylene"), (0.05, 0.3), (1e-3, 4e-3))
    t_end = log(rng, 0.5, 3.0)
    tool = {"preset": "clamp", "frame": "lab", "x1": ramp(0.0, 0.5 * t_end, log(rng, 0.05, 0.4) * d.L),
            "x3": ramp(0.0, 0.6 * t_end, -log(rng, 0.2, 0.5) * d.L)}  # fmt: skip
    shape = curve(arc(d.L, log(rng, 0.5, 1.5)), a1=[0.0, 1.0, 0.0])
    return case("suture", d.rod | {"kappa0": "initial"}, shape, ("clamp", tool), t_end,
                loads={"gravity": GRAVITY, "damping": log(rng, 1.0, 20.0)})  # fmt: skip


def whip(rng: Generator) -> Part:
    """A tapered whip that is swung by its handle."""
    d = Drawn(rng, ("rubber", "nylon"), (0.5, 3.0), (4e-3, 1e-2))
    width = {"s": [0.0, d.L], "value": [d.D, log(rng, 0.2, 0.6) * d.D], "interpolation": "linear"}
    t_end = log(rng, 0.3, 1.0) * sqrt(d.L)
    angle = log(rng, 0.4, 1.2)
    swing = {"t": [0.0, 0.2 * t_end, 0.4 * t_end], "value": [0.0, angle, 0.0], "interpolation": "smoothstep"}
    return case("whip", d.rod | {"diameter": width}, straight(1, 0, 0), ({"preset": "clamp", "theta2": swing}, "free"),
                t_end, loads={"gravity": GRAVITY, "damping": log(rng, 0.1, 2.0)})  # fmt: skip


def resonance(rng: Generator) -> Part:
    """A cantilever whose base is shaken near its first frequency."""
    d = Drawn(rng, ANY, (0.1, 2.0), (5e-3, 2e-2))
    period = d.period * log(rng, 0.8, 1.25)
    base = {"preset": "clamp", "frame": "lab", "x1": harmonic(log(rng, 2e-3, 2e-2) * d.L, period, 8.0 * period)}
    return case("resonance", d.rod, straight(0, 0, 1), (base, "free"), 8.0 * period, 60,
                loads={"damping": log(rng, 0.02, 0.3) / d.period})  # fmt: skip


def released(rng: Generator) -> Part:
    """A rod that is straight without stress, bent into an arc and let go."""
    d = Drawn(rng, ANY, (0.1, 2.0), (3e-3, 1e-2))
    shape = curve(arc(d.L, log(rng, 0.3, 4.0)), a1=[0.0, 1.0, 0.0])
    return case("released", d.rod, shape, ("clamp", "free"), 2.0 * d.period,
                loads={"damping": 0.0 if rng.random() < 0.4 else log(rng, 0.2, 2.0) / d.period})  # fmt: skip


def shaft(rng: Generator) -> Part:
    """A shaft between bearings that is brought to its speed."""
    d = Drawn(rng, ("steel", "carbon"), (0.3, 3.0), (5e-3, 2e-2))
    t_end = 12.0 * d.period
    speed = log(rng, 0.2, 0.8) * 2.0 * pi / d.period * 2.8
    drive = {"preset": "pin", "omega3": ramp(0.0, 0.5 * t_end, speed)}
    bearing = {"preset": "pin", "f3": 0.0, "q3": 0.0}
    return case("shaft", d.rod, straight(1, 0, 0), (drive, bearing), t_end,
                loads={"gravity": [0.0, 0.0, -9.81], "damping": log(rng, 0.1, 1.0) / d.period})  # fmt: skip


def swing(rng: Generator) -> Part:
    """A rope that is held out and let go: without damping."""
    d = Drawn(rng, ("nylon", "rubber", "polypropylene"), (0.5, 5.0), (3e-3, 1e-2))
    tilt = log(rng, 0.1, 1.5)
    t_end = 3.0 * 2.0 * pi * sqrt(2.0 * d.L / 3.0 / 9.81)
    return case("swing", d.rod, straight(tilt, 0, -1), ("pin", "free"), t_end, 60,
                loads={"gravity": GRAVITY})  # fmt: skip


def rope(rng: Generator) -> Part:
    """A limp rope that is let go: from the horizontal, or out of an arc one end of which is cut."""
    d = Drawn(rng, LIMP, (0.5, 30.0), (1e-3, 1e-2))
    shape = straight(1, 0, 0) if rng.random() < 0.5 else curve(arc(d.L, log(rng, 0.5, 2.5)), a1=[0.0, 1.0, 0.0])
    return case("rope", d.rod, shape, ("pin", "free"), log(rng, 1.0, 5.0) * 2.0 * pi * sqrt(d.L / 9.81), 50,
                loads={"gravity": GRAVITY, "damping": _little(rng) * sqrt(9.81 / d.L)})  # fmt: skip


def rope_struck(rng: Generator) -> Part:
    """A limp rope that hangs and is struck."""
    d = Drawn(rng, LIMP, (0.5, 30.0), (1e-3, 1e-2))
    t_end = log(rng, 1.0, 5.0) * 2.0 * pi * sqrt(d.L / 9.81)
    blow = _blow(0.02 * t_end, log(rng, 0.3, 3.0) * d.mass * 9.81 * d.L, t_end)
    loads = {"gravity": GRAVITY, "damping": _little(rng) * sqrt(9.81 / d.L),
             "point": [{"s": d.L * log(rng, 0.3, 1.0), "force": [0.0, blow, 0.0]}]}  # fmt: skip
    return case("rope-struck", d.rod, straight(0, 0, -1), ("pin", "free"), t_end, 50, loads=loads)


def struck(rng: Generator) -> Part:
    """A bar that is clamped at one end, or floats, and is struck."""
    d = Drawn(rng, ANY, (0.1, 2.0), (5e-3, 2e-2))
    held, t_end = "clamp" if rng.random() < 0.7 else "free", 3.0 * d.period
    blow = _blow(log(rng, 0.02, 0.1) * d.period, log(rng, 0.3, 5.0) * d.EJ / d.L**2, t_end)
    return case("struck", d.rod, straight(1, 0, 0), (held, "free"), t_end,
                loads={"damping": _little(rng) / d.period,
                       "point": [{"s": d.L * log(rng, 0.3, 1.0), "force": [0.0, blow, 0.0]}]})  # fmt: skip


def _little(rng: Generator) -> float:
    """Damping per time, as often as not none."""
    return 0.0 if rng.random() < 0.5 else log(rng, 0.02, 0.3)


def _blow(until: float, force: float, t_end: float) -> Part:
    """A force that rises to its most and is gone again."""
    return {"t": [0.0, 0.5 * until, until, t_end], "value": [0.0, force, 0.0, 0.0], "interpolation": "linear"}


def string(rng: Generator) -> Part:
    """A tight string that is plucked."""
    d = Drawn(rng, ("steel", "nylon"), (0.3, 1.0), (6e-4, 2e-3))
    strain = log(rng, 1e-3, 5e-3)
    wave = 2.0 * d.L / sqrt(d.E * strain / d.density)
    end = {"preset": "pin", "x3": ramp(0.0, wave, strain * d.L)}
    pluck = 2e-2 * d.E * strain * pi * d.D**2 / 4.0
    load = {"t": [0.0, wave, 2.0 * wave, 2.05 * wave], "value": [0.0, 0.0, pluck, 0.0], "interpolation": "linear"}
    return case("string", d.rod, straight(0, 0, 1), ("pin", end), 6.0 * wave, 60,
                loads={"damping": log(rng, 0.1, 1.0) / wave,
                       "point": [{"s": 0.2 * d.L, "force": [load, 0.0, 0.0]}]})  # fmt: skip


def fishing_rod(rng: Generator) -> Part:
    """A tapered rod that is lifted out of the horizontal, with a lure at its tip."""
    d = Drawn(rng, ("carbon", "glass fibre"), (1.5, 4.0), (2.5e-3, 5e-3))
    width = {"s": [0.0, d.L], "value": [1.5 * d.D, 0.4 * d.D], "interpolation": "linear"}
    lift = {"preset": "clamp", "theta2": ramp(0.0, log(rng, 0.3, 1.0), -log(rng, 0.3, 1.2))}
    lure = {"s": d.L, "force": [0.0, 0.0, -9.81 * log(rng, 5e-3, 5e-2)]}
    return case("fishing-rod", d.rod | {"diameter": width}, straight(1, 0, 0), (lift, "free"), log(rng, 1.0, 3.0),
                loads={"gravity": GRAVITY, "point": [lure], "damping": log(rng, 0.1, 2.0)})  # fmt: skip


def thrown(rng: Generator) -> Part:
    """A bent rod that is thrown, spinning."""
    d = Drawn(rng, ANY, (0.2, 2.0), (5e-3, 2e-2))
    spin = 2.0 * pi / d.period
    spins = [spin * log(rng, 0.05, 0.4), spin * log(rng, 0.05, 0.4), 0.0]
    motion = {"velocity": [1.0, 0.0, 3.0], "angular_velocity": spins}
    shape = curve(arc(d.L, log(rng, 0.2, 1.5)), a1=[0.0, 1.0, 0.0]) | motion
    rod = d.rod | ({"kappa0": "initial"} if rng.random() < 0.7 else {})
    return case("thrown", rod, shape, ("free", "free"), 4.0 * d.period, loads={"gravity": GRAVITY})


def rubber(rng: Generator) -> Part:
    """A cord that is pulled long: by a weight that falls with it, between its ends, one of which is shaken, or to be
    plucked."""
    d = Drawn(rng, ("rubber", "silicone"), (0.2, 20.0), (2e-3, 1e-2))
    EA, strain, way = d.E * pi * d.D**2 / 4.0, log(rng, 0.15, 1.0), str(rng.choice(("fall", "shake", "pluck")))
    rod = d.rod | {"axial_stiffness": EA}
    if way == "fall":  # in its last fiftieth is what would stretch it at rest by a third of the strain
        weight, period = strain / 3.0 * EA / 9.81 / (0.02 * d.L), 2.0 * pi * sqrt(strain / 3.0 * d.L / 9.81)
        parts = {"s": [0.0, 0.979 * d.L, 0.98 * d.L, d.L], "interpolation": "linear"}
        hanging = {"length": d.L, "diameter": d.D, "youngs_modulus": d.E, "shear_modulus": d.E / 3.0,
                   "mass_per_length": parts | {"value": [d.mass, d.mass, weight, weight]},
                   "axial_stiffness": parts | {"value": [EA, EA, 100.0 * EA, 100.0 * EA]}}  # fmt: skip
        let_go = {"preset": "pin", "frame": "lab", "switches": [{"at": 0.1 * period, "f1": 0.0, "f2": 0.0, "f3": 0.0}]}
        return case("rubber", hanging, straight(0, 0, -1), ("pin", let_go), 3.0 * period, 60,
                    loads={"gravity": GRAVITY, "damping": 0.02 / period})  # fmt: skip
    wave = 2.0 * d.L * (1.0 + strain) * sqrt(d.mass / (strain * EA))  # its first period as a string
    end = {"preset": "pin", "frame": "lab", "x1": ramp(0.0, 4.0 * wave, strain * d.L)}
    if way == "shake":
        end["x2"] = harmonic(0.1 * d.L, 3.0 * wave, 14.0 * wave)
        return case("rubber", rod, straight(1, 0, 0), ("clamp", end), 14.0 * wave, 60, loads={"gravity": GRAVITY})
    force = {"t": [6.0 * wave, 8.0 * wave, 8.2 * wave], "value": [0.0, 0.1 * strain * EA, 0.0],
             "interpolation": "linear"}  # fmt: skip
    return case("rubber", rod, straight(1, 0, 0), ("pin", end), 14.0 * wave, 60,
                loads={"damping": 0.1 / wave, "point": [{"s": 0.3 * d.L, "force": [0.0, force, 0.0]}]})  # fmt: skip


KINDS = (towed, umbilical, mooring, deep_sea, whirled, dropped, suture, whip, resonance, released, shaft, swing, rope,
         rope_struck, struck, string, fishing_rod, thrown, rubber)  # fmt: skip
