"""A host that gives little: another user than the one who installed, without a home, on a root that is read-only."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from numba import config

import solver
from solver.kernels.kernel import code_digest

NOBODY = 54321
"""A user whom this machine does not know, and who so has no home."""
AS_NOBODY = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups", "--no-new-privs",
             "--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search",
             "--securebits=+no_setuid_fixup"]  # fmt: skip
"""He may read where Python is installed, wherever that is, and write nowhere; securebits let os.access know it."""
READ_ONLY = ["unshare", "--mount", "sh", "-c",
             'mount --bind "$ROOM" "$ROOM" && mount -o remount,ro,bind / && cd "$ROOM" && exec "$@"', "sh"]
SMALL = ["--set", "t_end=0.05", "--set", "output.interval=0.05", "--set", "numerics.intervals=8"]


def allowed(*command: str) -> bool:
    room = {**os.environ, "ROOM": "/tmp"}
    return shutil.which(command[0]) is not None and not subprocess.run([*command, "true"], capture_output=True,
                                                                       env=room).returncode  # fmt: skip


pytestmark = pytest.mark.skipif(not allowed(*AS_NOBODY), reason="nobody here may become another user")
read_only = pytest.mark.skipif(not allowed(*READ_ONLY, *AS_NOBODY), reason="nobody here may mount")


@pytest.fixture
def room() -> Iterator[Path]:
    """The one directory that he may write to, with the place of his temporary files in it; below /tmp, since pytest's
    own may lie where only its owner gets to."""
    with TemporaryDirectory(dir="/tmp", prefix="hockle-room-") as name:
        (Path(name) / "tmp").mkdir()
        give(Path(name))
        yield Path(name)


def give(directory: Path) -> None:
    """Have everything in a directory be his."""
    for path in (directory, *directory.rglob("*")):
        os.chown(path, NOBODY, NOBODY)


@pytest.fixture(scope="module")
def kernels() -> Iterator[Path]:
    """A copy of the compiled kernels that is his: to compile them takes minutes, and to copy them seconds."""
    solver.warm()
    with TemporaryDirectory(dir="/tmp", prefix="hockle-kernels-") as name:
        copy = Path(name) / f"kernels-{code_digest()}"
        shutil.copytree(config.CACHE_DIR, copy)
        give(copy)
        yield copy


@pytest.fixture
def compiled(room: Path, kernels: Path) -> Iterator[None]:
    """They lie where he keeps them, as after his first run, until the test ends."""
    his = room / "tmp" / f"hockle-{NOBODY}"
    his.mkdir(mode=0o700)
    give(his)
    here = kernels.rename(his / kernels.name)
    yield
    here.rename(kernels)


def environment(room: Path, **told: str) -> dict[str, str]:
    return {"PATH": os.environ["PATH"], "ROOM": str(room), "TMPDIR": str(room / "tmp"),
            "HOCKLE_DATA": str(room / "data"), **told}  # fmt: skip


def hockle(room: Path, before: list[str], *words: str, **told: str) -> subprocess.CompletedProcess[str]:
    command = [*before, sys.executable, "-m", "hockle", *words]
    return subprocess.run(command, env=environment(room, **told), cwd=room, capture_output=True, text=True, timeout=600)


def test_another_user_without_a_home_is_told_once_where_the_kernels_lie(room):
    told = hockle(room, AS_NOBODY, "validate", "elastica")
    assert told.returncode == 0, told.stderr
    [line] = told.stderr.splitlines()
    assert line.startswith("the compiled solver cannot be kept in a home directory, it is kept in ")
    assert f"{room}/tmp/hockle-{NOBODY}/kernels-" in line


@pytest.mark.parametrize("home", ["/nowhere", "/proc"])
def test_a_home_that_is_not_his_is_no_obstacle(room, home):
    told = hockle(room, AS_NOBODY, "validate", "elastica", HOME=home)
    assert told.returncode == 0 and len(told.stderr.splitlines()) == 1, told.stderr


def test_kernels_that_he_can_only_read_are_used(room):
    """As in a container whose image holds them."""
    solver.warm()
    told = hockle(room, AS_NOBODY, "run", "cantilever-vibration", *SMALL, "-o", str(room / "out.nc"),
                  NUMBA_CACHE_DIR=config.CACHE_DIR)  # fmt: skip
    assert told.returncode == 0 and "cannot be kept" not in told.stderr, told.stderr
    assert list((room / "tmp").iterdir()) == []


def test_without_any_place_to_write_a_case_is_validated_all_the_same(room):
    (room / "tmp").chmod(0o500)
    told = hockle(room, [*READ_ONLY, *AS_NOBODY] if allowed(*READ_ONLY) else AS_NOBODY, "validate", "elastica",
                  TMPDIR="/proc")  # fmt: skip
    assert told.returncode == 0, told.stderr


def test_he_runs_a_case_with_the_kernels_that_he_has_compiled(room, compiled):
    told = hockle(room, AS_NOBODY, "run", "cantilever-vibration", *SMALL, "-o", str(room / "out.nc"))
    assert told.returncode == 0, told.stderr
    assert (room / "out.nc").stat().st_uid == NOBODY


@read_only
def test_on_a_read_only_root_he_runs_a_case(room, compiled):
    told = hockle(room, [*READ_ONLY, *AS_NOBODY], "run", "cantilever-vibration", *SMALL, "-o", str(room / "out.nc"))
    assert told.returncode == 0, told.stderr
    assert hockle(room, [*READ_ONLY, *AS_NOBODY], "run", "elastica", "-o", "/usr/out.nc").returncode == 1


@read_only
def test_on_a_read_only_root_he_serves_and_others_can_read_nothing_of_it(room, compiled):
    command = [*READ_ONLY, *AS_NOBODY, sys.executable, "-m", "hockle", "serve", "--port", "0", "--workers", "1"]
    with subprocess.Popen(command, env=environment(room), cwd=room, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, umask=0) as serving:  # fmt: skip
        try:
            lines: list[str] = []
            while not any("serves at" in line for line in lines):
                lines.append(serving.stdout.readline())
                assert lines[-1], "".join(lines)
            address = lines[-1].split()[3].rstrip(",")
            told = hockle(room, AS_NOBODY, "submit", "cantilever-vibration", *SMALL, "--wait", "--server", address)
            assert told.returncode == 0 and "successful" in told.stdout + told.stderr, told.stdout + told.stderr
        finally:
            serving.send_signal(signal.SIGTERM)
            serving.wait(60)
    open_to_others = {str(path): oct(path.stat().st_mode) for path in (room / "data", *(room / "data").rglob("*"))
                      if path.stat().st_mode & 0o077}  # fmt: skip
    assert not open_to_others


COMMANDS = """
import os, sys
from hockle.cli import main

for place, command in zip(sys.argv[1::2], sys.argv[2::2]):
    os.environ["HOCKLE_DATA"] = place
    print("status", main(command.split()), file=sys.stderr, flush=True)
"""


def test_a_data_directory_that_is_not_his_is_named_in_one_line(room):
    cases = [*(("/proc/data", command, "No such file or directory") for command in ("serve", "worker")),
             *(("/usr", command, "this user cannot write there") for command in ("serve", "api", "store check"))]
    command = [*AS_NOBODY, sys.executable, "-c", COMMANDS, *(text for case in cases for text in case[:2])]
    told = subprocess.run(command, env=environment(room), cwd=room, capture_output=True, text=True)
    said = [text.splitlines()[-1] for text in told.stderr.split("status 1\n")[:-1]]
    assert "Traceback" not in told.stderr and len(said) == len(cases), told.stderr
    for line, (place, _, rule) in zip(said, cases, strict=True):
        assert line.startswith(f"hockle: the directory {place}") and (rule in line or "Permission denied" in line)


def test_what_somebody_else_has_put_where_his_kernels_would_lie_is_not_executed(room):
    foreign = room / "tmp" / f"hockle-{NOBODY}"
    foreign.mkdir(mode=0o777)  # of this test's user
    told = hockle(room, AS_NOBODY, "validate", "elastica")
    assert told.returncode == 0
    [line] = told.stderr.splitlines()
    assert f"{foreign}/" not in line and f"{room}/tmp/hockle-" in line
