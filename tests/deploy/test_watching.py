"""Alerts and board ask for what the API tells, and alert when they should."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from prometheus_client import CollectorRegistry, generate_latest

from service.api.watching import _Measures, _Parts
from service.jobs import Database
from service.jobs.measures import Histogram, measure

FOLDER = Path(__file__).parents[2] / "deploy" / "prometheus"
NAME = re.compile(r"\bhockle_\w+")


@pytest.fixture
def told(tmp_path) -> set[str]:
    """The names of all that /metrics tells."""
    database = Database(f"sqlite:///{tmp_path / 'registry.db'}")
    measures = measure(database, 30.0, 0.0)
    database.close()
    one = Histogram("box", [0] * 16, 1, 0.0)
    measures.by_outcome[("successful", "completed")] = 1
    measures.bytes["someone"] = 1
    measures.drift_topology.append(one)
    measures.drift_energy.append(one)
    well = SimpleNamespace(database="ok", broker="ok", disk="ok", workers="ok", leader="ok", silent=["w"],
                           ages={"w": 1.0})
    registry = CollectorRegistry()
    for part in (_Parts(well), _Measures(measures, 1)):
        registry.register(part)
    return set(re.findall(r"^(hockle_\w+)", generate_latest(registry).decode(), re.M))


def test_the_rules_ask_for_what_there_is(told):
    groups = yaml.safe_load((FOLDER / "rules.yml").read_text())["groups"]
    asked = set(NAME.findall(" ".join(rule["expr"] for group in groups for rule in group["rules"])))
    assert asked and asked <= told


def test_the_board_asks_for_what_there_is(told):
    panels = json.loads((FOLDER / "grafana.json").read_text())["panels"]
    asked = set(NAME.findall(" ".join(target["expr"] for panel in panels for target in panel["targets"])))
    assert len(panels) == 12 and asked <= told


def test_every_rule_is_tried():
    [group] = yaml.safe_load((FOLDER / "rules.yml").read_text())["groups"]
    [tried] = yaml.safe_load((FOLDER / "tests.yml").read_text())["tests"]
    fires = {one["alertname"] for one in tried["alert_rule_test"] if one["exp_alerts"]}
    assert fires == {rule["alert"] for rule in group["rules"]}


@pytest.mark.skipif(shutil.which("promtool") is None, reason="no promtool on this machine (package prometheus)")
def test_promtool_lets_them_fire_when_they_should():
    subprocess.run(["promtool", "check", "rules", "rules.yml"], cwd=FOLDER, check=True)
    subprocess.run(["promtool", "test", "rules", "tests.yml"], cwd=FOLDER, check=True)
