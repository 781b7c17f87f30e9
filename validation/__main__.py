"""`python -m validation [name ...]`: run the scenes, print and keep their table, exit with 1 if an aim is missed."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from time import process_time

from validation.kept import keep
from validation.provenance import provenance
from validation.row import Row

SCENES = ("greenhill", "elastica", "statics", "post_buckling", "plectoneme", "knot", "euler", "ring", "cantilever",
          "convergence", "error_bars", "energy", "free_flight", "writhe", "linear_solve", "goyal", "staggered",
          "thick_cable")  # fmt: skip
RESULTS = Path(__file__).parent / "results"
HEADER = f"{'':4}  {'what':<78}{'measured':>16}{'reference':>16}{'error':>11}{'aim':>10}"


def line(row: Row) -> str:
    """A row as text."""
    verdict = "ok" if row.passed else "MISS"
    return (f"{verdict:4}  {row.name:<78}{row.measured:>16.9g}{row.reference:>16.9g}"
            f"{row.error:>11.2e}{row.aim:>10.1e}")  # fmt: skip


def main(names: list[str]) -> int:
    """Run the scenes of these names, or all."""
    unknown = [name for name in names if name not in SCENES]
    if unknown:
        print(f"unknown scene {unknown[0]!r}: must be one of {', '.join(SCENES)}", file=sys.stderr)
        return 2
    RESULTS.mkdir(exist_ok=True)
    printed = [*provenance(), "", HEADER]
    print("\n".join(printed), flush=True)
    missed = 0
    for name in names or SCENES:
        started = process_time()
        rows = import_module(f"validation.{name}").rows()
        missed += sum(not row.passed for row in rows)
        text = [*map(line, rows), f"      {name}: {process_time() - started:.1f} s of CPU time"]
        print("\n".join(text), flush=True)
        printed += text
        keep(name, rows)
    printed.append(f"{missed} aims missed" if missed else "every aim met")
    print(printed[-1])
    (RESULTS / f"{'-'.join(names) or 'all'}.txt").write_text("\n".join(printed) + "\n", encoding="utf-8")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
