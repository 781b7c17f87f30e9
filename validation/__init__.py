"""Published scenes, and what a correct solver must show on them. `python -m validation [name ...]` prints the table."""

import os

from hockle.parts import SINGLE_THREADED

os.environ.update(SINGLE_THREADED | os.environ)
