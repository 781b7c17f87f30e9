"""`python -m hockle` is the `hockle` command."""

import sys

from hockle.cli import main

sys.exit(main())
