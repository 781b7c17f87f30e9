"""`python -m chaos.cpus`: run every case with kernels compiled for other CPUs; 1 if any variable differs by a bit.

A job may be resumed by another host, whose CPU may differ. For it kernels are compiled, and by it NumPy chooses its
loops. This machine can only be told to be less than it is, so the others are older. What BLAS is to be is told to all
of them, as it should be where hosts differ: OPENBLAS_CORETYPE.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile

from chaos.cases import cases, undisturbed
from chaos.report import RESULTS
from validation.provenance import provenance

AVX2 = "+avx,+avx2,+fma,+bmi,+bmi2,+lzcnt,+popcnt,+sse4.1,+sse4.2"
NO_AVX512 = "X86_V4 AVX512_ICL"
HOSTS: dict[str, dict[str, str]] = {
    "this one": {},
    "Haswell": {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": AVX2, "NPY_DISABLE_CPU_FEATURES": NO_AVX512},
    "Zen": {"NUMBA_CPU_NAME": "znver1", "NUMBA_CPU_FEATURES": AVX2, "NPY_DISABLE_CPU_FEATURES": NO_AVX512},
}
PROGRAM = "from chaos.cpus import tell; tell()"


def tell() -> None:
    """Print the digest of each case's dataset, as JSON."""
    print(json.dumps({name: undisturbed(case) for name, case in cases().items()}))


def digests(host: dict[str, str]) -> dict[str, str]:
    """The digest of each case's dataset as such a host makes it; its kernels are compiled first."""
    with tempfile.TemporaryDirectory(prefix="hockle-cpus-") as kernels:
        environment = {"XDG_CACHE_HOME": kernels, "OPENBLAS_CORETYPE": "Haswell", "PYTHONWARNINGS": "ignore"}
        ran = subprocess.run([sys.executable, "-c", PROGRAM], env=os.environ | environment | host, check=True,
                             stdout=subprocess.PIPE, text=True)  # fmt: skip
    return dict(json.loads(ran.stdout))


def main() -> int:
    """Run all, print and keep the table."""
    by_host = {name: digests(host) for name, host in HOSTS.items()}
    same = {case: len({hashes[case] for hashes in by_host.values()}) == 1 for case in cases()}
    rows = [("case", *by_host, "the same"), ("---",) * (len(by_host) + 2)]
    rows += [(case, *(hashes[case][:12] for hashes in by_host.values()), "yes" if same[case] else "**no**")
             for case in same]  # fmt: skip
    lines = ["# The same bits on every CPU", "", *(f"- {line}" for line in provenance()), ""]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    text = "\n".join([*lines, ""])
    print(text)
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "cpus.md").write_text(text, encoding="utf-8")
    return 0 if all(same.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
