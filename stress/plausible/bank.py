"""The scenes of the bank, each by its kind and number: the same on every machine."""

from __future__ import annotations

import zlib

import numpy as np

from stress.plausible import moving, still
from stress.plausible.parts import Part

KINDS = {kind.__name__: kind for kind in (*still.KINDS, *moving.KINDS)}
EACH = 25
"""Scenes of each kind in the bank."""


def scene(kind: str, number: int) -> Part:
    """A case of a kind."""
    rng = np.random.default_rng([zlib.crc32(kind.encode()), number])
    return KINDS[kind](rng)
