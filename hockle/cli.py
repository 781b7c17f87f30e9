"""The `hockle` command."""

from __future__ import annotations

import argparse
import errno
import os
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version

from hockle.failure import Failure
from hockle.parts import SINGLE_THREADED

COMMANDS = ("local", "plots", "film", "serving", "parts", "keys", "store", "remote", "jobs", "operating", "sweep",
            "again", "completion", "demo")

FULL = (errno.ENOSPC, errno.EDQUOT)
UNIX_ONLY = ("fcntl", "resource")
"""Modules of Python that Windows lacks."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command that the arguments name; the process ends with the status that this returns."""
    os.environ.update(SINGLE_THREADED | os.environ)  # before numpy is imported
    parsed = parser().parse_args(arguments)
    command: Callable[[argparse.Namespace], int] = parsed.run
    try:
        return command(parsed)
    except Failure as failure:
        print(f"hockle: {failure}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        if error.name not in UNIX_ONLY:
            raise
        print("hockle: this command needs Linux or macOS, for it locks files as they do: on Windows use it in WSL; "
              "cases, validate and what talks to a server work everywhere", file=sys.stderr)  # fmt: skip
        return 1
    except BrokenPipeError:  # the reader of a pipe, such as head, has enough
        sys.stderr.close()
        return 0
    except OSError as error:
        if error.errno not in FULL:
            raise
        print(f"hockle: there is no room left for {error.filename or 'what it writes'}: {error.strerror}",
              file=sys.stderr)  # fmt: skip
        return 1
    except KeyboardInterrupt:
        print("hockle: interrupted", file=sys.stderr)
        return 130


def parser() -> argparse.ArgumentParser:
    """The parser of all commands; each of COMMANDS adds its own."""
    top = argparse.ArgumentParser(prog="hockle", description="Kirchhoff rod dynamics, alone or as a service.")
    top.add_argument("--version", action="version", version=f"hockle {version('hockle')}")
    subparsers = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for name in COMMANDS:
        import_module(f"hockle.{name}").register(subparsers)
    return top
