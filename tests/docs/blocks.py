"""What the pages show: each block, and each text in a line that is set as code, in their order."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

from docs import interface
from service.api.app import create_app
from service.settings import Settings

ROOT = Path(__file__).parents[2]
MADE = ("build", "demo", "dist", "var")
"""Folders of what commands have made."""
PAGES = [path.relative_to(ROOT).as_posix() for path in sorted(ROOT.rglob("*.md"))
         if not path.relative_to(ROOT).parts[0].startswith((".", *MADE))]  # fmt: skip
INTERFACE = "<!-- interface -->"
MARKDOWN = MarkdownIt().enable("table")


@dataclass(frozen=True)
class Block:
    """A block of code; an indented one has commands."""

    language: str
    text: str


def text_of(page: str) -> str:
    """What a page says; that of the interface is made from its document."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return text.replace(INTERFACE, interface.page(create_app(Settings()).openapi())) if INTERFACE in text else text


def cells(text: str) -> list[Block]:
    """The cells of a notebook that hold code."""
    return [Block("python", "".join(cell["source"])) for cell in json.loads(text)["cells"]
            if cell["cell_type"] == "code"]  # fmt: skip


def blocks(text: str) -> list[Block]:
    """The blocks of a page."""
    return [Block(token.info or "console", token.content) for token in MARKDOWN.parse(text)
            if token.type in ("fence", "code_block")]  # fmt: skip


def in_lines(text: str) -> Iterator[str]:
    """What is set as code within the lines and tables of a page."""
    for token in MARKDOWN.parse(text):
        yield from (child.content for child in token.children or () if child.type == "code_inline")


def commands(block: Block) -> list[tuple[str, str]]:
    """The commands of a block, each with the answer that is shown; without a prompt all its lines are commands."""
    lines = block.text.splitlines()
    if not any(line.startswith("$ ") for line in lines):
        return [(line, "") for line in lines]
    found: list[tuple[str, str]] = []
    for line in lines:
        if line.startswith("$ "):
            found.append((line.removeprefix("$ "), ""))
        else:
            command, answer = found.pop()
            found.append((command, f"{answer}{line}\n"))
    return found
