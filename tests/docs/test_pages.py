"""What the pages for beginners show is so: every command and every block, in their order."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from hockle.cli import main, parser
from service.cases import load_case, parse_case
from service.jobs import Database, NewJob, Registry
from service.settings import Settings
from tests.hockle.conftest import serving
from worker.run import run_next

DOCS = Path(__file__).parents[2] / "docs"
SHOWN = re.compile(r"^    \$ (hockle [^\n]*)$|^```(json|python)\n(.*?)^```", re.M | re.S)
REFUSED = "rod.diameter=-1"


def shown(page: str) -> list[tuple[str, str]]:
    """The commands and blocks of a page: what it is, and its text."""
    found = SHOWN.findall((DOCS / page).read_text())
    return [(language or "command", command or block) for command, language, block in found]


def command(line: str) -> None:
    status = main(shlex.split(line)[1:])
    assert status == (1 if REFUSED in line else 0), line


def follow(page: str, address: str = "") -> list[str]:
    """Do what a page shows, in the working directory; the kinds of what was done."""
    for kind, text in shown(page):
        if kind == "command":
            command(text)
        elif kind == "json":
            Path("hose.json").write_text(text)
        else:
            exec(compile(text.replace("http://127.0.0.1:8000", address), page, "exec"), {})
    return [kind for kind, _ in shown(page)]


def test_the_first_ten_minutes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert follow("first-ten-minutes.md") == ["command"] * 5 + ["python"]
    said = capsys.readouterr()
    assert "completed" in said.out and "rod/diameter" in said.err
    assert (tmp_path / "cantilever-vibration-snapshots.png").exists()


def test_the_tutorial(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with serving(tmp_path / "served") as server:
        follow("tutorial.md", server.address)
    said = capsys.readouterr().out
    assert said.splitlines()[-3:] == ["successful completed"] * 3
    assert (tmp_path / "hose-topology.png").exists()
    assert (tmp_path / "hose.gif").read_bytes().startswith(b"GIF8")


def test_accuracy(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert follow("accuracy.md") == ["command", "python", "command"]
    [(met, error)] = re.findall(r"^(yes|no) (\d\S+)$", capsys.readouterr().out, re.M)
    assert met == "yes" and 0.0 < float(error) < 1e-2


def test_a_backup_is_restored_and_whole(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOCKLE_DATA", str(tmp_path / "served"))
    settings = Settings(data=tmp_path / "served")
    settings.make_directories()
    database = Database(settings.database_url)
    Registry(database).submit(NewJob(parse_case(load_case("free-flight")).document()))
    assert run_next(database, settings)
    database.close()
    for kind, line in shown("deploy/backup.md"):
        assert kind == "command"
        command(line.replace("/backups/hockle", str(tmp_path / "backup")))


PAGES = [DOCS.parent / "README.md", *sorted(DOCS.rglob("*.md"))]
COMMAND = re.compile(r"^    (?:\$ |docker compose run .*?api )?(hockle [a-z].*)$", re.M)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(DOCS.parent).as_posix())
def test_every_command_of_a_page_is_understood(page):
    for line in COMMAND.findall(page.read_text()):
        parser().parse_args(shlex.split(line, comments=True)[1:])


def test_commands_are_found():
    assert sum(len(COMMAND.findall(page.read_text())) for page in PAGES) > 40
