"""How hockle is installed: all under the one name `hockle`, which collides with nobody's (docs/decisions/0026)."""

import re
import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.egg_info import egg_info

PARTS = ("outcomes", "solver", "service", "worker", "hockle_client")
"""The repository's packages that an installation has as `hockle.solver` and so on."""

NAMES = "|".join(PARTS)
WHOLE = re.compile(rf"^(\s*)import ({NAMES})$", re.M)
WITHIN = re.compile(rf"""((?:^|[^.\w])from |["'])({NAMES})(?=\.| import )""", re.M)
"""A module of ours that a line imports, or that a string names."""


def installed(source: str) -> str:
    """The text of a module as an installation has it."""
    return WITHIN.sub(r"\1hockle.\2", WHOLE.sub(r"\1from hockle import \2", source))


class BuildUnderOneName(build_py):
    """Builds the packages, then moves those of PARTS below `hockle`; not where the checkout itself is installed."""

    def run(self) -> None:
        """Build."""
        built = Path(self.build_lib)
        if self.editable_mode:
            super().run()
            return
        shutil.rmtree(built, ignore_errors=True)
        super().run()
        for part in PARTS:
            (built / part).rename(built / "hockle" / part)
        for module in (built / "hockle").rglob("*.py"):
            module.write_text(installed(module.read_text(encoding="utf-8")), encoding="utf-8")


class NameOne(egg_info):
    """Tells that one name as all that is installed."""

    def run(self) -> None:
        """Write the metadata."""
        super().run()
        (Path(self.egg_info) / "top_level.txt").write_text("hockle\n")


setup(cmdclass={"build_py": BuildUnderOneName, "egg_info": NameOne})
