"""The languages of the blocks, and how each is run."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from typing import TYPE_CHECKING, Any

import httpx
import pytest

from service.cases import load_case, parse_case
from service.settings import from_environment
from tests.docs.blocks import ROOT, Block, commands
from tests.docs.instead import compose

if TYPE_CHECKING:
    from tests.docs.page import Page


def console(page: Page, block: Block) -> None:
    """Commands, each with its answer."""
    for line, shown in commands(block):
        page.command(line, shown)


def python(page: Page, block: Block) -> None:
    """Code, which goes on with the names of the blocks before; or, where it is indented, a passage of the sources."""
    if block.text.startswith(" "):
        passage = " ".join(block.text.split())
        assert any(passage in " ".join(path.read_text().split()) for path in (ROOT / "solver").rglob("*.py")), passage
        return
    file = page.folder / f"page_{len(page.names)}.py"  # numba's cache wants a file
    file.write_text(page.real(block.text))
    printed = StringIO()
    with redirect_stdout(printed), redirect_stderr(StringIO()):
        exec(compile(file.read_text(), str(file), "exec"), page.names)
    page.printed += printed.getvalue()


def json_block(page: Page, block: Block) -> None:
    """Cases, which lie in a file of their name from then on; parts of a case; bodies of requests."""
    text = page.real(block.text).strip()
    while text:
        document, end = json.JSONDecoder().raw_decode(text)
        text = text[end:].lstrip()
        if "schema_version" in document:
            (page.folder / f"{document['name']}.json").write_text(json.dumps(document))
            parse_case(document)
        elif {"parameters", "members"} & set(document):
            request(page, "ensembles", document)
        elif {"case", "job"} & set(document):
            request(page, "jobs", document)
        elif set(document) == {"seconds"}:
            request(page, f"jobs/{page.stage.done.id}/links", document)
        else:
            parse_case(load_case("goyal-2003") | document)


def request(page: Page, where: str, document: dict[str, Any]) -> None:
    """Send a body. What is accepted is not run to its end: its cases are long."""
    headers = {"Authorization": f"Bearer {page.key}"} if "webhook" in document else {}
    with httpx.Client(base_url=page.stage.address, headers=headers) as client:
        answer = client.post(f"/v1/{where}", json=document)
        assert answer.is_success, (document, answer.text)
        if where in ("jobs", "ensembles"):
            client.post(f"/v1/{where}/{answer.json()['id']}/cancel").raise_for_status()


def toml(page: Page, block: Block) -> None:
    """A file of settings."""
    (page.folder / "settings.toml").write_text(block.text)
    assert from_environment({"HOCKLE_SETTINGS": str(page.folder / "settings.toml")})


def variables(page: Page, block: Block) -> None:
    """Settings in the environment: each is one, and what is set is not the default."""
    values = dict(line.split("=", 1) for line in block.text.splitlines())
    settings, default = from_environment(values).environment(), from_environment({}).environment()
    assert [name for name in values if settings[name] == default[name]] == []


def math(page: Page, block: Block) -> None:
    """A formula, as the site sets it."""
    converter = pytest.importorskip("latex2mathml.converter", reason="no MkDocs: make .venv/.docs")
    assert "<math" in converter.convert(block.text, display="block")


LANGUAGES: dict[str, Callable[[Page, Block], None]] = {
    "console": console, "python": python, "json": json_block, "toml": toml, "sh": variables, "yaml": compose,
    "math": math,
}  # fmt: skip
