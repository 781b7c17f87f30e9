"""What is compiled before a run is all that it needs: nothing compiles, or loads from the cache, in its middle."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCENES = {"hanging-cable": {"t_end": 1.0}, "short-loop": {"t_end": 3.0}, "free-flight": {"t_end": 0.1}}
PROGRAM = """
import sys
from importlib import import_module
from pkgutil import walk_packages
from numba.core.registry import CPUDispatcher
import solver
from service.cases import apply_settings, build_scene, load_case, parse_case

def compiled():
    modules = [import_module(module.name) for module in walk_packages(solver.__path__, "solver.")]
    kernels = {kernel for module in modules for kernel in vars(module).values() if isinstance(kernel, CPUDispatcher)}
    return {(str(kernel), str(signature)) for kernel in kernels for signature in kernel.signatures}

solver.warm(sys.argv[1])
before = compiled()
for name, settings in %s.items():
    case = apply_settings(load_case(name), settings | {"numerics.method": sys.argv[1]})
    frames = list(solver.simulate(build_scene(parse_case(case))))
    print(name, frames[-1].contacts)
print(sorted(compiled() - before))
"""


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_a_warm_process_compiles_nothing(method):
    """Found under stress: two kernels were left to the run."""
    command = [sys.executable, "-c", PROGRAM % SCENES, method]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert any(int(line.split()[1]) > 0 for line in told[:-1])  # there was contact
    assert told[-1] == "[]"
