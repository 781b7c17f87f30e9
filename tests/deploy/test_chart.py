"""The Helm chart, by Helm's own engine and the schemas of Kubernetes."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
import yaml

from chaos.postgres import binaries, postgres
from hockle.cli import parser
from service.jobs import Database, NewJob, Registry
from service.settings import Settings

CHART = Path(__file__).parents[2] / "deploy" / "helm"
KUBERNETES = ("1.29", "1.33")
FULL = {"autoscaling": {"enabled": True}, "clients": {"app": "ingress"}, "settings": {"HOCKLE_LEASE": "60"},
        "api": {"host": "hockle.example"}}  # fmt: skip
LITTLE = {"store": ""}


def rendered(values: dict[str, Any]) -> list[dict[str, Any]]:
    """The objects that an installation with these values makes."""
    helm = pytest.importorskip("helm_python", reason="no Helm library: pip install -r requirements-deploy.txt")
    with helm.Chart.load(str(CHART)) as chart:
        texts = chart.render(values, name="demo", namespace="prod")
    return [told for name, text in sorted(texts.items()) if name.endswith(".yaml") for told in yaml.safe_load_all(text)]


def one(values: dict[str, Any], kind: str, part: str) -> dict[str, Any]:
    [found] = [told for told in rendered(values) if (told["kind"], told["metadata"]["name"]) == (kind, f"demo-{part}")]
    return found


def test_helm_has_nothing_against_it():
    helm = pytest.importorskip("helm_python", reason="no Helm library: pip install -r requirements-deploy.txt")
    assert helm.lint(str(CHART))["errors"] == []


@pytest.mark.parametrize("values", [{}, FULL, LITTLE], ids=["as it is", "full", "little"])
@pytest.mark.parametrize("version", KUBERNETES)
def test_kubernetes_would_take_its_objects(values, version):
    kubernetes = pytest.importorskip("kubernetes_validate", reason="no schemas: pip install -r requirements-deploy.txt")
    told = [each for each in rendered(values) if not each["apiVersion"].startswith("keda.sh/")]
    assert [each["kind"] for each in told].count("Deployment") == 2
    for each in told:
        kubernetes.validate(each, version, strict=True)


@pytest.mark.parametrize("wrong", [{"worker": {"grace": 5}}, {"settings": {"hockle_lease": "1"}}, {"imagee": {}}])
def test_values_that_make_no_sense_are_refused(wrong):
    helm = pytest.importorskip("helm_python", reason="no Helm library: pip install -r requirements-deploy.txt")
    with pytest.raises(helm.HelmError):
        rendered(wrong)


@pytest.mark.parametrize("part", ["api", "worker"])
def test_a_pod_may_do_little_and_runs_a_command_that_exists(part):
    pod = one(FULL, "Deployment", part)["spec"]["template"]["spec"]
    [container] = pod["containers"]
    assert parser().parse_args(container["args"][1:])
    assert pod["securityContext"]["runAsNonRoot"] and not pod["automountServiceAccountToken"]
    allowed = container["securityContext"]
    assert allowed["readOnlyRootFilesystem"] and not allowed["allowPrivilegeEscalation"]
    assert allowed["capabilities"] == {"drop": ["ALL"]}
    assert {each["name"] for each in container["env"]} <= set(Settings().environment())


def test_a_worker_has_longer_than_a_checkpoint_to_hand_its_jobs_back():
    pod = one({}, "Deployment", "worker")["spec"]["template"]["spec"]
    assert pod["terminationGracePeriodSeconds"] > 2 * Settings().checkpoint
    assert "kill -QUIT 1" in pod["containers"][0]["lifecycle"]["preStop"]["exec"]["command"][-1]


def test_what_scales_and_what_is_scaled_do_not_both_set_the_replicas():
    assert "replicas" not in one(FULL, "Deployment", "worker")["spec"]
    target = one(FULL, "ScaledObject", "worker")["spec"]["scaleTargetRef"]["name"]
    assert target == one(FULL, "Deployment", "worker")["metadata"]["name"]


@pytest.mark.skipif(binaries() is None, reason="no PostgreSQL on this machine")
def test_the_query_that_scales_is_the_age_of_the_queue():
    import psycopg

    query = one(FULL, "ScaledObject", "worker")["spec"]["triggers"][0]["metadata"]["query"]
    with postgres(synced=False) as server:
        database = Database(server.create("scaling"))

        def age() -> float:
            with psycopg.connect(server.url("scaling").replace("+psycopg", "")) as connection:
                [found] = connection.execute(query).fetchone() or [None]
            return float(found)

        assert age() == 0.0
        job = Registry(database).submit(NewJob({"case": "any"}))
        assert 0.0 <= age() <= time.time() - job.created + 1.0
        database.close()
