"""A page that is followed: what it shows is done, block by block, in a directory of its own."""

from __future__ import annotations

import platform
import shlex
import time
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import Any

from tests.docs.answers import ID, agrees
from tests.docs.blocks import Block
from tests.docs.languages import LANGUAGES
from tests.docs.programs import PROGRAMS
from tests.docs.stage import Stage

PATIENCE = 60.0


class Page:
    """A page that is followed."""

    def __init__(self, stage: Stage, folder: Path) -> None:
        """Nothing is done yet; the directory is the working directory, and empty."""
        self.stage, self.folder = stage, folder
        self.names: dict[str, Any] = {"__name__": "page"}
        self.printed = ""
        self.line = ""
        self.port = 0
        self.ids: dict[str, str] = {}
        self.ending = ExitStack()
        (folder / "kept").mkdir()

    def follow(self, blocks: list[Block]) -> None:
        """Do what they show. What they have started runs until their end."""
        with self.ending:
            for block in blocks:
                assert block.language in LANGUAGES, f"nothing runs a block of {block.language!r}:\n{block.text}"
                LANGUAGES[block.language](self, block)

    def real(self, text: str) -> str:
        """A text of the page, with the addresses, keys, directories and jobs that there are here."""
        here = {"http://127.0.0.1:8000": self.stage.address, "localhost:8000": self.stage.address,
                "http://10.0.0.7:8000": self.stage.address, "--host NAME": f"--host {platform.node()}"}  # fmt: skip
        here |= {place: str(self.folder / "kept" / Path(place).name)
                 for place in ("/backups/hockle", "/backup/hockle", "/tmp/restored")}
        for there, name in here.items():
            text = text.replace(there, name)
        if "PREFIX" in text or "hk_..." in text:
            text = text.replace("PREFIX", self.key.split("_")[1]).replace("hk_...", self.key)
        return ID.sub(lambda match: self.ids.get(match[0]) or self.stage.done.id, text)

    @cached_property
    def key(self) -> str:
        """The text of an API key of the page's own."""
        return self.stage.new_key()

    def command(self, line: str, shown: str = "") -> None:
        """Run a command of the page."""
        self.run(self.real(line), shown)

    def run(self, line: str, shown: str = "") -> None:
        """Run a command. What it answers is what is shown, where something is; a refusal is shown by its sentence."""
        self.line, words = line, shlex.split(line, comments=True)
        assert words[0] in PROGRAMS, f"nothing runs {line!r}"
        again = words[0] == "curl" and not {"-X", "-d"} & set(words)  # a question may be asked until it is so
        deadline = time.monotonic() + PATIENCE
        while not self._agrees(shown, answer := PROGRAMS[words[0]](self, words, shown)):
            assert again and time.monotonic() < deadline, f"{line}\nanswers\n{answer}\ninstead of\n{shown}"
            time.sleep(0.1)
        self.printed += answer

    def _agrees(self, shown: str, answer: str) -> bool:
        """Whether it answers as shown; ids that are shown for the first time are those of the answer."""
        new = [one for one in ID.findall(shown) if one not in self.ids]
        for one, other in zip(new, ID.findall(answer), strict=False):
            self.ids[one] = other
        return not shown or agrees(ID.sub(lambda match: self.ids.get(match[0], match[0]), shown), answer)
