"""The client is light, typed, and what is written of it by a command is up to date."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib.metadata import distribution, version
from pathlib import Path

import pytest
from mypy import api

from generate.__main__ import HERE, WRITTEN
from hockle_client import documents
from service.api import cases, ensemble_data, ensembles, links
from service.api import documents as services
from service.cases import case_schema
from tests.docs.blocks import blocks, text_of

CLIENT = Path(__file__).parents[2] / "client"
PROJECT = tomllib.loads((CLIENT / "pyproject.toml").read_text())["project"]
LIGHT = 15_000_000


@pytest.mark.parametrize("name", WRITTEN)
def test_what_a_command_writes_is_up_to_date(name):
    assert (HERE / name).read_text(encoding="utf-8") == WRITTEN[name](), "run `make client`"


@pytest.mark.parametrize(("ours", "theirs"), [
    (documents.JobState, services.JobDocument), (documents.DatasetInfo, services.DatasetDocument),
    (documents.Limits, services.LimitsDocument), (documents.Cost, cases.CostDocument),
    (documents.CaseWarning, cases.WarningDocument), (documents.Verdict, cases.Verdict),
    (documents.Link, links.LinkDocument), (documents.EnsembleState, ensembles.EnsembleDocument),
    (documents.MemberState, ensembles.MemberDocument), (documents.SobolIndex, ensemble_data.SobolIndex),
])  # fmt: skip
def test_what_the_service_says_is_what_the_client_reads(ours, theirs):
    assert {"href" if name == "url" else name for name in ours.model_fields} == set(theirs.model_fields)
    assert set(services.Status) == set(documents.Status.__args__)


def test_it_needs_httpx_and_pydantic_only_and_is_light():
    needed, todo = set(), [re.match(r"[\w-]+", one)[0] for one in PROJECT["dependencies"]]
    assert todo == ["httpx", "pydantic"]
    while todo:
        name = todo.pop().lower().replace("_", "-")
        if name not in needed:
            needed.add(name)
            todo += [re.match(r"[\w-]+", one)[0] for one in distribution(name).requires or () if ";" not in one]
    files = [file.locate() for name in needed for file in distribution(name).files]
    size = sum(file.stat().st_size for file in {*files, *(CLIENT / "hockle_client").rglob("*")} if file.is_file())
    assert size < LIGHT
    heavy = "xarray", "pandas", "numpy", "netCDF4", "solver", "service", "hockle"
    code = f"import hockle_client, sys; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", code], cwd=CLIENT, text=True).strip() == "[]"


def test_it_has_the_version_of_hockle():
    assert PROJECT["version"] == version("hockle")
    assert PROJECT["requires-python"] == ">=3.10"


TYPED = '''
from hockle_client import Case, Client, JobState
from hockle_client.schema import OutputSpec, RodSpec

rod = RodSpec(length=1.0, diameter=0.01)
state: JobState = Client().submit({{"rod": rod}}, set={{"t_end": 1}}).wait().state
tolerance = Case.shipped("goyal-2003").set("numerics.tolerance", 1e-4)
wrong = {wrong}
'''


def checked(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, int]:
    """What a strict type checker says of a program, and its status."""
    monkeypatch.setenv("MYPYPATH", str(CLIENT))
    (folder / "mine.py").write_text(text)
    options = ["--strict", "--python-version", "3.10", "--follow-imports", "silent", "--ignore-missing-imports"]
    out, _, status = api.run([*options, "--cache-dir", str(folder.parent / "mypy"), str(folder / "mine.py")])
    return out, status


@pytest.mark.parametrize(("wrong", "said"), [
    ("1", ""), ("RodSpec(lenght=1.0, diameter=0.01)", 'Extra key "lenght"'),
    ('OutputSpec(interval="often")', 'expression has type "str"'), ("state.progess", 'no attribute "progess"'),
    ("Client().job('1').dataset().nothing()", ""),
])  # fmt: skip
def test_a_type_checker_finds_what_is_misspelled(tmp_path, monkeypatch, wrong, said):
    out, status = checked(TYPED.format(wrong=wrong), tmp_path, monkeypatch)
    assert (said in out and status == 1) if said else status == 0, out


def test_a_type_checker_finds_no_fault_with_the_page_of_the_client(tmp_path, monkeypatch):
    page = "".join(block.text for block in blocks(text_of("docs/client.md")) if block.language == "python")
    out, status = checked(page, tmp_path, monkeypatch)
    assert status == 0, out


def test_every_key_of_a_case_is_offered():
    import typing

    from hockle_client.schema import Setting

    offered = typing.get_args(Setting)
    assert set(case_schema()["properties"]) <= set(offered)
    assert {"numerics.tolerance", "ends.end.omega3", "loads.floor.stiffness", "output.interval"} <= set(offered)
