"""What is installed from the wheel, beside nothing of the checkout, works."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import urllib.request
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LONG = os.environ.get("WHEEL") == "long"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w", str(folder)]
    subprocess.run([*command, str(ROOT)], check=True)
    [made] = folder.glob("hockle-*.whl")
    return made


@pytest.fixture(scope="module")
def hockle(wheel, tmp_path_factory) -> Path:
    """The command of an environment that has the wheel, and of this one only the libraries."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    site = Path(sysconfig.get_path("purelib", "venv", {"base": str(folder)}))
    subprocess.run([sys.executable, "-m", "pip", "--python", str(folder / "bin" / "python"), "install", "--quiet",
                    "--no-deps", str(wheel)], check=True)  # fmt: skip
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib"))
    return folder / "bin" / "hockle"


def told(hockle: Path, *arguments: str, **options: object) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    ended = subprocess.run([hockle, *arguments], check=True, capture_output=True, text=True, cwd=hockle.parent,
                           env=environment | {name: str(value) for name, value in options.items()})  # fmt: skip
    return ended.stdout


def test_its_only_package_is_hockle(wheel):
    with zipfile.ZipFile(wheel) as archive:
        folders = {name.split("/")[0] for name in archive.namelist()}
        [described] = [name for name in archive.namelist() if name.endswith("/top_level.txt")]
        assert archive.read(described).decode().split() == ["hockle"]
    assert {folder for folder in folders if not folder.endswith(".dist-info")} == {"hockle"}


def test_it_holds_every_file_of_the_packages(wheel):
    with zipfile.ZipFile(wheel) as archive:
        inside = set(archive.namelist())
    tracked = subprocess.run(["git", "ls-files", "outcomes", "solver", "service", "worker", "hockle", "client"],
                             cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()  # fmt: skip
    own = [name.removeprefix("client/") for name in tracked if not name.startswith("client/")
           or name.startswith("client/hockle_client/")]  # fmt: skip
    assert [name for name in own if not {name, f"hockle/{name}"} & inside] == []


def test_no_import_in_it_is_of_a_name_that_is_not_installed(wheel):
    """As a module would be named that somebody else's distribution holds."""
    strange = re.compile(r"^\s*(?:from|import) (outcomes|solver|service|worker|hockle_client)\b", re.M)
    with zipfile.ZipFile(wheel) as archive:
        modules = [name for name in archive.namelist() if name.endswith(".py")]
        assert [name for name in modules if strange.search(archive.read(name).decode())] == []


def test_its_command_validates_a_shipped_case(hockle):
    assert "goyal-2003 is valid" in told(hockle, "validate", "goyal-2003")
    assert "goyal-2003" in told(hockle, "cases")


def test_it_serves(hockle, tmp_path):
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kernels"), "REDIS_URL": ""}
    process = subprocess.Popen([hockle, "serve", "--port", "0", "--workers", "1", "--data", str(tmp_path)],
                               stdout=subprocess.PIPE, text=True, cwd=hockle.parent, env=environment)
    try:
        address = process.stdout.readline().split()[3].rstrip(",")
        with urllib.request.urlopen(f"{address}/readyz") as answer:
            assert json.load(answer)["database"] == "ok"
        with urllib.request.urlopen(f"{address}/dashboard/main.js") as answer:
            assert answer.status == 200
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)
        process.stdout.close()


@pytest.mark.skipif(not LONG, reason="compiles the solver anew, which takes minutes: WHEEL=long")
def test_it_runs_a_case(hockle, tmp_path):
    tiny = ["t_end=0.1", "output.interval=0.1", "numerics.intervals=4"]
    settings = [word for one in tiny for word in ("--set", one)]
    said = told(hockle, "run", "elastica", *settings, "-o", str(tmp_path / "out.nc"),
                NUMBA_CACHE_DIR=tmp_path, NUMBA_OPT=0)
    assert said.startswith("elastica: completed")
    assert (tmp_path / "out.nc").read_bytes()[:4] == b"\x89HDF"
