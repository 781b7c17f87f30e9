"""The threat model names tests that exist; the runbook knows every sign, and names settings that exist."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from service.api import watching
from service.api.front import Readiness
from service.settings import FILE, Settings, variable

DOCS = Path(__file__).parents[1] / "docs"
THREATS, RUNBOOK = ((DOCS / name).read_text(encoding="utf-8") for name in ("threat-model.md", "runbook.md"))
LINK = re.compile(r"\[([^\]]+)\]\(([^)#]*)(#[^)]*)?\)")
RISKS = [f"API{number}" for number in range(1, 11)]


def anchors(text: str) -> set[str]:
    """Where links to headings lead, as GitHub names them."""
    heads = re.findall(r"^#+ (.*)$", text, re.M)
    return {"#" + re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize(("words", "path", "anchor"), [*LINK.findall(THREATS), *LINK.findall(RUNBOOK)])
def test_every_link_leads_somewhere(words, path, anchor):
    target = DOCS / path if path else None
    assert target is None or target.exists()
    if words.startswith("test_"):
        assert re.search(rf"^(async )?def {words}\(", target.read_text(), re.M)
    if anchor:
        assert anchor in anchors(target.read_text() if target else RUNBOOK)


def test_each_threat_names_what_shows_that_it_is_kept_out():
    heads = ("| ---", "| he tries", "| what happens", "| found", "| number | risk")
    rows = [line for line in THREATS.splitlines() if line.startswith("| ") and not line.startswith(heads)]
    assert len(rows) > 30
    assert [row for row in rows if "test_" not in row] == []
    assert [risk for risk in RISKS if f"| {risk} |" not in THREATS] == []


def test_every_alert_and_every_part_of_readyz_has_its_place():
    [group] = yaml.safe_load((DOCS.parent / "deploy" / "prometheus" / "rules.yml").read_text())["groups"]
    alerts = {rule["alert"] for rule in group["rules"]}
    assert alerts == set(re.findall(r"^### (Hockle\w+)$", RUNBOOK, re.M))
    assert [part for part in Readiness.model_fields if part != "status" and f"| `{part}` |" not in RUNBOOK] == []


def test_every_metric_has_its_place():
    named = set(re.findall(r'"(hockle_\w+)"', Path(watching.__file__).read_text()))
    assert len(named) > 10
    assert [name for name in sorted(named) if not re.search(rf"`{name}(_total)?`", RUNBOOK)] == []


def test_every_setting_that_is_named_exists():
    known = {variable(field.name) for field in fields(Settings)} | {FILE}
    assert set(re.findall(r"\bHOCKLE_[A-Z_]+\b", THREATS + RUNBOOK)) <= known
