"""The guide's table of commands: each as short as it may be, and with each of its options."""

from __future__ import annotations

import os
import platform
import shlex
from collections.abc import Callable, Iterator

from tests.docs.blocks import in_lines, text_of
from tests.docs.programs import APART
from tests.docs.stage import Stage

VALUES = {"--set": "t_end=0.2", "--label": "listed", "--status": "successful", "--since": "2000-01-01",
          "--until": "2999-01-01T12:00", "-n": "3", "--seconds": "0.2", "--at": "0.1", "--start": "omega3=0",
          "--end": "omega3=0", "--sample": "sobol", "--size": "2", "--seed": "1", "--scalars": "Tw,Wr",
          "--scopes": "read", "--days": "1", "--host": platform.node()}  # fmt: skip
"""What stands behind an option."""
NAMES = {"CASE": "quick.json", "SHIPPED": "elastica", "KEY=V1,V2,": "loads.damping=0.1,0.2",
         "KEY=LOW:HIGH": "loads.damping=0:1", "OWNER": "owner"}  # fmt: skip


def usages() -> list[str]:
    """What the table shows, but for what runs until a signal, and the demonstration: blocks of pages have these."""
    table = text_of("docs/guide.md").partition("## Command line")[2].partition("\n## ")[0]
    return [usage for usage in in_lines(table) if usage.startswith("hockle ") and usage.split()[1] not in APART]


def forms(usage: str) -> Iterator[str]:
    """A usage without what stands in brackets, and with each of these by itself."""
    bare, options, depth = "", [], 0
    for letter in usage:
        depth -= letter == "]"
        if depth:
            options[-1] += letter
        elif letter == "[":
            options.append("")
        elif letter != "]":
            bare += letter
        depth += letter == "["
    yield bare
    yield from (f"{bare} {form}" for option in options for form in forms(option))


def command(form: str, stage: Stage) -> str:
    """The command that a form stands for on the stage."""
    words = shlex.split(form)
    here: dict[str, Callable[[], str]] = {
        "URL": lambda: stage.address, "D": lambda: os.environ["HOCKLE_DATA"],
        "PREFIX": lambda: stage.new_key().split("_")[1], "ID": lambda: stage.job_for(words[1]),
    }  # fmt: skip
    for before, (k, word) in zip(["", *words], enumerate(words), strict=False):
        name = word.removesuffix("...")
        if before == "--ensemble":
            words[k] = stage.ensemble
        elif name in here:
            words[k] = here[name]()
        else:
            words[k] = VALUES.get(before) or NAMES.get(name, name)
    return shlex.join(words)
