"""One build: runs the scenes named on its standard input, and answers with their CPU times (s)."""

from __future__ import annotations

import json
import sys
from time import process_time

from benchmarks.skipping.scenes import ONE_AXIS, SCENES
from solver import simulate


def main() -> None:
    """Until the input ends."""
    scenes = SCENES | ONE_AXIS
    for line in sys.stdin:
        name, method = json.loads(line)
        scene = scenes[name](method)
        started = process_time()
        for _ in simulate(scene):
            pass
        print(process_time() - started, flush=True)


if __name__ == "__main__":
    main()
