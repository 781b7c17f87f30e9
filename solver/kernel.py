"""How every compiled kernel is compiled: single-threaded, cached on disk, no bounds checks, no NaN swallowed.

Numba's cache does not see that a kernel called from another file has changed. So the cache lives in a folder
named by a digest of the whole solver: another version of the code has another cache, and nothing compiles twice.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

_OPTIONS: dict[str, Any] = {
    "cache": True, "no_cfunc_wrapper": True, "error_model": "numpy", "fastmath": {"contract", "arcp"},
}  # fmt: skip
"""`arcp`: divisions by constants and by what does not change in a loop become multiplications."""


@cache
def code_digest() -> str:
    """What tells this version of the solver from every other: a digest of its sources."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """The folder of this version's compiled kernels, below the user's cache."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return home / "hockle" / f"kernels-{code_digest()}"


if "NUMBA_CACHE_DIR" not in os.environ:
    numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]


def kernel(function: Function) -> Function:
    """Compile a function of plain arrays and numbers."""
    return numba.njit(**_OPTIONS)(function)  # type: ignore[no-any-return]


def inlined(function: Function) -> Function:
    """Compile a function that is to vanish into its callers: one that is called for every node or interval."""
    return numba.njit(inline="always", **_OPTIONS)(function)  # type: ignore[no-any-return]
