"""What is compiled before a run is all that it needs: nothing compiles, or loads from the cache, in its middle."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from numba import config

from solver.kernels import kernel
from solver.kernels.kernel import compile_apart

SCENES = {"hanging-cable": {"t_end": 1.0}, "short-loop": {"t_end": 3.0}, "free-flight": {"t_end": 0.1}}
PROGRAM = """
import sys
from importlib import import_module
from pkgutil import walk_packages
from numba.core.registry import CPUDispatcher
import solver
from service.cases import apply_settings, build_scene, load_case, parse_case

def kernels():
    modules = [import_module(module.name) for module in walk_packages(solver.__path__, "solver.")]
    return {kernel for module in modules for kernel in vars(module).values() if isinstance(kernel, CPUDispatcher)}

def compiled():
    return {(str(kernel), str(signature)) for kernel in kernels() for signature in kernel.signatures}

solver.warm(*sys.argv[2:])
before = compiled()
for name, settings in %s.items():
    case = apply_settings(load_case(name), settings | {"numerics.method": sys.argv[1]})
    frames = list(solver.simulate(build_scene(parse_case(case))))
    print(name, frames[-1].contacts)
print(sorted(compiled() - before))
print([str(kernel) for kernel in kernels() if kernel.stats.cache_misses])
print([str(kernel) for kernel in kernels() if kernel.targetoptions.get("fastmath")])
"""


@pytest.mark.parametrize(("method", "named"), [("box", ["box"]), ("staggered", ["staggered"]), ("staggered", [])])
def test_a_warm_process_compiles_nothing(method, named):
    """Found under stress: two kernels were left to the run."""
    command = [sys.executable, "-c", PROGRAM % SCENES, method, *named]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert any(int(line.split()[1]) > 0 for line in told[:-3])  # there was contact
    assert told[-3:-1] == ["[]", "[]"]
    assert told[-1] == "[]"  # each operation rounds as IEEE 754 has it: the same bits however it was inlined


def test_what_is_not_in_the_cache_is_compiled_by_another_process_and_once(tmp_path, monkeypatch):
    """LLVM's memory is not to be a job's."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    marks = tmp_path / "marks"
    mark = f"import os, solver; open({str(marks)!r}, 'a').write(str(os.getpid()) + ' ')"
    compile_apart("some", f"{mark}; raise SystemExit(1)")
    for _ in range(2):
        compile_apart("some", mark)
    compile_apart("others", mark)
    found = marks.read_text().split()
    assert len(found) == len(set(found)) == 3  # after the first, which failed, once for each name
    assert str(os.getpid()) not in found


COMPILE = """
import sys
from numba import config
from solver.kernels import kernel
config.CACHE_DIR = sys.argv[1]
kernel.compile_apart("some", sys.argv[2])
"""


def test_whoever_finds_others_compiling_waits_for_them_even_if_who_began_was_killed(tmp_path, until):
    """Workers killed on a cold cache once left a dozen compilations behind, all of the same kernels."""
    marks, go_on = tmp_path / "marks", tmp_path / "go on"
    slowly = (f"import time; from pathlib import Path; open({str(marks)!r}, 'a').write('compiling ');"
              f"[time.sleep(.01) for _ in range(6000) if not Path({str(go_on)!r}).exists()];"
              f"open({str(marks)!r}, 'a').write('compiled ')")  # fmt: skip
    command = [sys.executable, "-c", COMPILE, str(tmp_path), slowly]
    first = subprocess.Popen(command)
    until(marks.exists, "the first compiles")
    others = [subprocess.Popen(command) for _ in range(2)]
    first.kill()
    first.wait()
    with pytest.raises(subprocess.TimeoutExpired):
        others[0].wait(3.0)  # seconds, in which it would have begun
    assert marks.read_text().split() == ["compiling"]
    go_on.touch()
    assert [process.wait() for process in others] == [0, 0]
    assert marks.read_text().split() == ["compiling", "compiled"] * 2  # who was killed could not say that it is done


def test_another_checkout_of_the_same_code_that_shares_the_cache_compiles_for_itself(tmp_path, monkeypatch):
    """Numba's files are told apart by their sources' place: what says that they are there must be, too."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    marks = tmp_path / "marks"
    mark = f"open({str(marks)!r}, 'a').write('compiled ')"
    for place in ("here", "there", "here"):
        monkeypatch.setattr(kernel, "__file__", str(tmp_path / place / "solver" / "kernels" / "kernel.py"))
        kernel._good_for.cache_clear()
        compile_apart("some", mark)
    monkeypatch.undo()
    kernel._good_for.cache_clear()
    assert marks.read_text().split() == ["compiled", "compiled"]
