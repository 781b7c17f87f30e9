"""hockle completion: what a shell needs to complete the commands."""

from __future__ import annotations

import argparse
from typing import Any

SHELLS = ("bash", "zsh", "tcsh")


def register(subparsers: Any) -> None:
    """Add `hockle completion`."""
    parser = subparsers.add_parser("completion", help="print what completes these commands in a shell")
    parser.add_argument("shell", choices=SHELLS, help='as in eval "$(hockle completion bash)"')
    parser.set_defaults(run=completion)


def completion(arguments: argparse.Namespace) -> int:
    """Print the shell's script."""
    import shtab

    from hockle.cli import parser

    print(shtab.complete(parser(), arguments.shell))
    return 0
