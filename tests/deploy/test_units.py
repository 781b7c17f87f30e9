"""The units of systemd, as its own programs read them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from configparser import ConfigParser
from pathlib import Path

import pytest

from service.settings import Settings

DEPLOY = Path(__file__).parents[2] / "deploy"
UNITS = sorted((DEPLOY / "systemd").glob("*.service"))
EXPOSURE = "20"
"""Tenths, of systemd's ten for a unit that may do all: OK is below 50."""
systemd = pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd-analyze on this machine")


@pytest.fixture(params=UNITS, ids=lambda path: path.stem)
def unit(request, tmp_path) -> Path:
    """The unit, with the command of this environment."""
    made = tmp_path / request.param.name
    here = Path(sys.executable).parent / "hockle"
    made.write_text(request.param.read_text().replace("/opt/hockle/bin/hockle", str(here)))
    return made


@systemd
def test_a_unit_is_understood(unit):
    ended = subprocess.run(["systemd-analyze", "verify", str(unit)], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")


@systemd
def test_a_unit_may_do_little(unit):
    command = ["systemd-analyze", "security", "--offline=yes", f"--threshold={EXPOSURE}", str(unit)]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stdout.splitlines()[-1]


@pytest.mark.parametrize("path", UNITS, ids=lambda path: path.stem)
def test_a_stop_is_given_longer_than_a_checkpoint(path):
    parser = ConfigParser(strict=False, interpolation=None)
    parser.optionxform = str
    parser.read(path)
    if "api" not in path.stem:
        assert float(parser["Service"]["TimeoutStopSec"]) > 2 * Settings().checkpoint
