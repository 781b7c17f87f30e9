"""What README.md and docs/guide.md show is so."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
from pathlib import Path
from shutil import which

import pytest

from hockle.cli import main
from hockle_client import Client
from service.cases import CaseSpec, parse_case, shipped_cases
from service.results.schema import VARIABLES
from service.settings import Settings
from solver import Outcome
from tests.hockle.conftest import serving

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
GUIDE = (ROOT / "docs" / "guide.md").read_text()


def blocks(language: str, containing: str = "") -> list[str]:
    found = re.findall(rf"^```{language}\n(.*?)^```", README, re.M | re.S)
    return [block for block in found if containing in block]


def printed_number(text: str) -> float:
    return float(re.findall(r"-?\d+\.\d+", text)[-1])


def test_the_case_runs_and_xarray_reads_what_the_readme_says(tmp_path, monkeypatch, capsys):
    [case] = blocks("json")
    [reading] = blocks("python", "import xarray")
    parse_case(json.loads(case))
    monkeypatch.chdir(tmp_path)
    Path("sagging-rod.json").write_text(case)
    assert main(["run", "sagging-rod.json"]) == 0
    capsys.readouterr()
    exec(compile(reading, "README.md", "exec"), {})
    [told] = re.findall(r"# (-\d\.\d+) \(m\)", reading)
    # The tip still swings by about 1 mm, and its phase is the step control's.
    assert printed_number(capsys.readouterr().out) == pytest.approx(float(told), abs=1e-3)


def test_the_solver_alone_prints_what_the_readme_says(capsys):
    [snippet] = blocks("python", "from solver import")
    exec(compile(snippet, "README.md", "exec"), {})
    # The last two digits: the swing that is left after 4 s, and the error of 50 intervals.
    assert printed_number(capsys.readouterr().out) == pytest.approx(-0.27610, abs=2e-4)


def test_the_commands_draw_and_film_the_case(tmp_path, monkeypatch):
    [case] = blocks("json")
    monkeypatch.chdir(tmp_path)
    Path("sagging-rod.json").write_text(case)
    for line in re.findall(r"^    \$ hockle (.*sagging-rod.*)$", README, re.M):
        assert main([*line.split(), *(["--seconds", "0.2"] if line.startswith("film") else [])]) == 0
    assert {"sagging-rod.mp4", "sagging-rod-snapshots.png"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.skipif(which("curl") is None, reason="there is no curl")
def test_curl_gets_what_the_readme_says(tmp_path, monkeypatch):
    [case] = blocks("json")
    monkeypatch.chdir(tmp_path)
    Path("sagging-rod.json").write_text(case)
    commands = re.findall(r"^    \$ (curl .*)$", README, re.M)
    with serving(tmp_path / "served") as server:
        first = None
        for line in commands:
            told = re.sub(r"\b[0-9a-z]{26}\b", first or "none", line.replace("localhost:8000", server.address))
            command = [*shlex.split(told), "--fail", "--silent", "--show-error"]
            got = subprocess.run(command, capture_output=True, text=True)
            assert got.returncode == 0, (told, got.stderr)
            if first is None:
                first = json.loads(got.stdout)["id"]
                Client(server.address).job(first).wait()
    assert len(commands) == 8 and list(tmp_path.glob("*.nc"))


def test_every_path_that_the_readme_names_is_there():
    linked = [target for target in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in target]
    folders = [folder for row in re.findall(r"^\| (`.*?`) \|", README, re.M) for folder in re.findall(r"`(.*?)`", row)]
    missing = [path for path in linked + folders if not (ROOT / path).exists()]
    assert linked and folders and not missing
    assert (ROOT / "docs/pictures/goyal-2003-snapshots.png").stat().st_size < 300_000


def test_the_guide_names_every_field_of_a_case():
    schema = CaseSpec.model_json_schema()
    parts = [schema, *schema["$defs"].values()]
    names = {name for part in parts for name in part.get("properties", {})}
    # the eighteen conditions of an end are listed as v1, v2, v3 and so on
    assert [name for name in sorted(names) if not re.search(rf"`[^`]*\b{name}\b[^`]*`", GUIDE)] == []


@pytest.mark.parametrize(
    "names",
    [
        [variable.name for variable in VARIABLES],
        [outcome.value for outcome in Outcome],
        list(Settings().environment()),
        list(shipped_cases()),
    ],
    ids=["variables", "outcomes", "settings", "cases"],
)
def test_the_guide_names_everything(names):
    assert [name for name in names if f"`{name}`" not in GUIDE] == []
