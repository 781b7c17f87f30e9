"""What the pages show is so: every command and every block of every page is run, in its order."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from subprocess import CalledProcessError

import pytest

from service.cases import apply_settings, load_case
from tests.docs.blocks import PAGES, Block, blocks, cells, text_of
from tests.docs.claims import CLAIMS
from tests.docs.page import Page
from tests.docs.stage import QUICK, Stage
from tests.docs.usages import command, forms, usages
from tests.hockle.conftest import serving

NOTEBOOK = "docs/sweep.ipynb"
SWEEPS = {"200)": "4)", '"numerics.intervals", 100': '"numerics.intervals", 20).set("output.interval", 0.1'}
SHORTER: dict[str, dict[str, str]] = {
    "README.md": {'set={"t_end": 30}': 'set={"t_end": 0.3}'},
    "client/README.md": {"1e-4)": '1e-2).set("t_end", 0.3)'},
    "docs/client.md": {**SWEEPS, "fork(5.0": "fork(0.15", "30.0": "0.3", "40.0": "0.4", "(10.0, 20.0)": "(0.1, 0.2)",
                       "t_min=10.0": "t_min=0.1", "size=8, seed=1": 'size=2, seed=1, set={"t_end": 0.3}',
                       'label="sweep").wait': 'label="sweep", set={"t_end": 0.3}).wait'},
    "docs/guide.md": {'"at": 10': '"at": 0.15'},
    "docs/tutorial.md": {'"t_end": 20.0': '"t_end": 4.0'},
    NOTEBOOK: {**SWEEPS, '"t_end", 30.0)': '"t_end", 0.3)', '"t_end": 35.0': '"t_end": 0.4'},
}  # fmt: skip
"""Fewer and shorter runs: what stands on a page, and what is run instead."""


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    data = tmp_path_factory.mktemp("served")
    with serving(data) as server:
        assert server.address, server.first_line + server.process.stdout.read()
        yield Stage(server.address, data)


@pytest.fixture
def page(stage, tmp_path, monkeypatch) -> Page:
    """A page that nobody has followed yet, in the working directory."""
    monkeypatch.chdir(tmp_path)
    for variable, value in stage.environment.items():
        monkeypatch.setenv(variable, value)
    return Page(stage, tmp_path)


@pytest.mark.parametrize("name", [*PAGES, NOTEBOOK])
@pytest.mark.filterwarnings("error::FutureWarning")
def test_what_a_page_shows_is_so(name, request):
    shown = shorter(name, cells(text_of(name)) if name == NOTEBOOK else blocks(text_of(name)))
    if not shown:
        return
    page: Page = request.getfixturevalue("page")
    page.follow(shown)
    if name in CLAIMS:
        CLAIMS[name](page)


def test_every_command_of_the_guide_runs_with_each_of_its_options(page, monkeypatch):
    Path("quick.json").write_text(json.dumps(apply_settings(load_case("goyal-2003"), {**QUICK, "name": "quick"})))
    ran = []
    for number, form in enumerate(form for usage in usages() for form in forms(usage)):
        if "restore" in form:
            monkeypatch.setenv("HOCKLE_DATA", str(page.folder / f"restored-{number}"))
        page.run(command(form, page.stage))
        ran.append(form.split()[1])
    assert len(ran) > 80 and {"run", "keys", "store", "submit", "sweep", "requeue"} <= set(ran)


def shorter(name: str, shown: list[Block]) -> list[Block]:
    """The blocks, with fewer and shorter runs."""
    for long, short in SHORTER.get(name, {}).items():
        assert any(long in block.text for block in shown), f"{name} does not have {long} any more"
        shown = [replace(block, text=block.text.replace(long, short)) for block in shown]
    return shown


def test_what_nothing_runs_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = Page(Stage("http://127.0.0.1:9", tmp_path), tmp_path)
    for text in ("    kubectl get pods\n", "```fortran\nend\n```\n", "    $ make hay\n", "    hockle fly\n"):
        with pytest.raises((AssertionError, CalledProcessError, SystemExit)):
            page.follow(blocks(text))
