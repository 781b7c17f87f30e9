"""The programs whose commands the pages show, and how each is run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from shutil import which
from typing import TYPE_CHECKING
from unittest import SkipTest

import httpx

from chaos.campaign import free_port
from hockle.cli import main
from tests.docs.blocks import ROOT
from tests.docs.instead import docker, helm, pip, pytest

if TYPE_CHECKING:
    from tests.docs.page import Page

PATIENCE = 60.0
SHORTER = {"goyal-2003": ["--set", "t_end=0.3", "--set", "output.interval=0.1"], "film": ["--seconds", "0.2"]}
"""What is put behind a command of `hockle` in which the word stands."""


def hockle(page: Page, words: list[str], shown: str) -> str:
    """A command of ours: in this process, unless it starts others."""
    if words[1] in APART:
        return APART[words[1]](page, words)
    for word, more in SHORTER.items():
        words += more if word in words[1:3] else []
    refused = shown.startswith("hockle: ")
    out, err = StringIO(), StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = main(words[1:])
    assert status == int(refused), (words, out.getvalue(), err.getvalue())
    return (err if refused else out).getvalue()


def demo(page: Page, words: list[str]) -> str:
    """The demonstration, once for all pages."""
    if not page.stage.demonstrated:
        subprocess.run([sys.executable, "-m", *words], check=True, capture_output=True, env=apart(page))
        page.stage.demonstrated = (page.folder / "demo" / "goyal-2003.nc").exists()
    assert page.stage.demonstrated
    return ""


def serve(page: Page, words: list[str]) -> str:
    """A service of its own, not beyond loopback, until the page's end."""
    log = started(page, [*words, "--host", "127.0.0.1", "--port", "0"], apart(page))
    wait(lambda: "serves at" in log.read_text(), log)
    return ""


def api(page: Page, words: list[str]) -> str:
    """The API alone, at another port, until the page's end."""
    page.port = free_port()
    log = started(page, [str(page.port) if word == "8000" else word for word in words], apart(page))
    wait(lambda: "broker" in parts(page), log)
    return ""


def worker(page: Page, words: list[str]) -> str:
    """A worker alone, of which the API beside it says that it gets on."""
    log = started(page, words, apart(page))
    wait(lambda: parts(page).get("workers") == "ok", log)
    return ""


def apart(page: Page) -> dict[str, str]:
    """The environment of a service of the page's own."""
    return {**os.environ, "HOCKLE_DATA": str(page.folder / "apart"), "REDIS_URL": ""}


def parts(page: Page) -> dict[str, str]:
    """What the API that the page has started says of the parts of its service."""
    try:
        return dict(httpx.get(f"http://127.0.0.1:{page.port}/readyz", timeout=20.0, trust_env=False).json())
    except httpx.TransportError:
        return {}


def started(page: Page, words: list[str], environment: dict[str, str]) -> Path:
    """Start what runs until a signal, which it gets at the page's end; gives its log."""
    path = page.folder / f"{words[1]}.log"
    with path.open("w") as log:
        command = [sys.executable, "-m", *words]
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment)

    def stop() -> None:
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE) in (0, -signal.SIGTERM), path.read_text()

    page.ending.callback(stop)
    return path


def wait(condition: Callable[[], bool], log: Path) -> None:
    """Until something is so; the bound only keeps a broken test from waiting for ever."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, log.read_text()
        time.sleep(0.05)


def curl(page: Page, words: list[str], shown: str) -> str:
    """A request; refused where a problem is shown."""
    if which("curl") is None:
        raise SkipTest("there is no curl")
    fail = [] if "urn:hockle:problem" in shown else ["--fail"]
    command = [*words, "--silent", "--show-error", *fail]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def make(page: Page, words: list[str], shown: str) -> str:
    """The commands that make would run, but for what installs: these tests have what is installed."""
    dry = subprocess.run(["make", "--dry-run", *words[1:]], cwd=ROOT, check=True, capture_output=True, text=True)
    ours = [line for line in dry.stdout.splitlines() if line.startswith(".venv/bin/") and " -m pip " not in line]
    assert ours, f"nothing runs {' '.join(words)}"
    for line in ours:
        page.run(line.removeprefix(".venv/bin/").removeprefix("python -m "))
    return ""


def shell(page: Page, words: list[str], shown: str) -> str:
    """A line of the shell's own."""
    return subprocess.run(["sh", "-ec", page.line], check=True, capture_output=True, text=True).stdout


def activate(page: Page, words: list[str], shown: str) -> str:
    """The environment has the command."""
    line = f"cd {Path(sys.prefix).parent}; . {words[1]}; command -v hockle"
    return subprocess.run(["sh", "-ec", line], check=True, capture_output=True, text=True).stdout


PROGRAMS: dict[str, Callable[[Page, list[str], str], str]] = {
    "hockle": hockle, "curl": curl, "make": make, "printf": shell, ".": activate,
    "docker": docker, "helm": helm, "pip": pip, "pytest": pytest,
}  # fmt: skip
APART: dict[str, Callable[[Page, list[str]], str]] = {"demo": demo, "serve": serve, "api": api, "worker": worker}
