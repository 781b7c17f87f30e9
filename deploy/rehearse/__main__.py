"""`python -m deploy.rehearse` (make rehearse): build the image, run docker-compose.yml with two workers, break things.

Needs root and what needed.py names. The first time takes ten minutes to an hour, most of it the compiler's. What it did
and saw is kept in deploy/results/rehearsal.md.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from contextlib import ExitStack
from pathlib import Path

from deploy.rehearse import needed
from deploy.rehearse.image import Builder
from deploy.rehearse.network import network
from deploy.rehearse.record import Record
from deploy.rehearse.stage import Stage
from deploy.rehearse.steps import STEPS

KEPT = Path("/var/tmp/hockle-rehearsal")
"""Where base and image stay from one rehearsal to the next."""


def main() -> None:
    """Rehearse; the exit status says whether all went as it should."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--keep", type=Path, default=KEPT, help=f"where base and image lie (default {KEPT})")
    parser.add_argument("--built", action="store_true", help="take the image that is there")
    told = parser.parse_args()
    if missing := needed.missing():
        parser.exit(1, f"the rehearsal needs {', '.join(missing)}\n")
    record = Record()
    with ExitStack() as cleanup:
        folder = Path(tempfile.mkdtemp(prefix="hockle-rehearsal-"))
        folder.chmod(0o755)
        cleanup.callback(shutil.rmtree, folder, ignore_errors=True)
        builder = Builder(told.keep, told.keep / "build.log")
        cleanup.callback(builder.close)
        if not told.built:
            with record.step("the base is made and the image built on it"):
                builder.base()
                builder.build()
        image = builder.image()
        stage = Stage(folder, image, cleanup.enter_context(network(folder / "hosts")))
        cleanup.callback(stage.close)
        for step in STEPS:
            with record.step(step.__doc__ or step.__name__) as say:
                say(step(stage))
    record.write(image.commit)


if __name__ == "__main__":
    main()
