"""What the lines of the pages name as commands is there, and the guide's table has every command with its options."""

from __future__ import annotations

import argparse
import re
import subprocess
from collections.abc import Iterator
from importlib.util import find_spec

import pytest

from hockle.cli import parser
from tests.docs.blocks import PAGES, ROOT, in_lines, text_of

NAMED = sorted({text for page in PAGES for text in in_lines(text_of(page))
                if re.match(r"(hockle|make|python -m|pytest) ", text)})  # fmt: skip
OPTION = re.compile(r"(?<![\w-])--?[a-z][a-z-]*")


def below(top: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The commands below a command, by their names."""
    [found] = [action.choices for action in top._actions if isinstance(action, argparse._SubParsersAction)] or [{}]
    return dict(found)


def named(text: str) -> tuple[str, argparse.ArgumentParser]:
    """The command of ours that a text names. Raises KeyError for one that there is not."""
    name, command = "", parser()
    for word in text.split()[1:]:
        if not below(command):
            break
        name, command = f"{name} {word}".lstrip(), below(command)[word]
    return name, command


def options(command: argparse.ArgumentParser) -> Iterator[set[str]]:
    """The spellings of each of its options."""
    return (set(one.option_strings) for one in command._actions if one.option_strings and one.dest != "help")


@pytest.mark.parametrize("text", NAMED)
def test_a_command_that_a_line_names_is_there(text):
    program, *words = text.split()
    if program == "make":
        subprocess.run(["make", "--dry-run", words[0]], cwd=ROOT, check=True, capture_output=True)
    elif program == "pytest":
        assert (ROOT / words[0]).exists()
    elif program == "python":
        assert find_spec(words[1])
    else:
        assert set(OPTION.findall(text)) <= set().union(*options(named(text)[1]))


def test_the_image_takes_what_pages_build_it_with():
    named = {name for page in PAGES for name in re.findall(r"--build-arg (\w+)=", text_of(page))}
    assert named and named <= set(re.findall(r"^ARG (\w+)", (ROOT / "deploy" / "Dockerfile").read_text(), re.M))


def test_the_guide_has_every_command_with_every_option():
    shown: dict[str, set[str]] = {}
    for usage in in_lines(text_of("docs/guide.md").partition("## Command line")[2].partition("\n## ")[0]):
        if usage.startswith("hockle "):
            shown.setdefault(named(usage)[0], set()).update(OPTION.findall(usage))
    commands = {f"{name} {sub}".strip(): command for name, top in below(parser()).items()
                for sub, command in (below(top) or {"": top}).items()}  # fmt: skip
    missing = {name: [one for one in options(command) if not one & shown.get(name, set())]
               for name, command in commands.items()}  # fmt: skip
    assert set(commands) == set(shown) and {name: one for name, one in missing.items() if one} == {}
