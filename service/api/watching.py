"""/metrics for Prometheus, /v1/audit for who did what: for operators."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Query, Response
from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.registry import Collector
from pydantic import BaseModel, ConfigDict, Field

from service.api.description import problems
from service.api.health import Health
from service.api.numbers import WHOLE
from service.api.parts import InParts, Operator
from service.jobs.audit import trail
from service.jobs.measures import BOUNDS, Histogram, Measures, measure

TEXT: dict[int | str, dict[str, object]] = {
    200: {"description": "The metrics", "content": {"text/plain": {"schema": {"type": "string"}}}}
}
router = APIRouter(tags=["service"])


class DeedDocument(BaseModel):
    """Who did what: `subject` is a job's id, or the prefix of a key."""

    id: int
    time: datetime
    owner: str
    key: str
    action: str
    subject: str


class TrailDocument(BaseModel):
    """A page of the audit trail, newest first; `next` is the address of the following page."""

    deeds: list[DeedDocument]
    next: str | None


class Stretch(BaseModel):
    """Which part of the trail."""

    model_config = ConfigDict(extra="forbid")
    limit: Annotated[int, Field(ge=1, le=1000), WHOLE] = 100
    before: Annotated[int | None, Field(ge=0, le=2**62, description="only deeds before this one"), WHOLE] = None


@router.get("/metrics", response_class=Response, responses={**TEXT})
def metrics(parts: InParts, _: Operator) -> Response:
    """Parts and processes, queue, leases, steps, outcomes, bytes and drift, in the text format of Prometheus; only the
    parts while the database is away."""
    registry = CollectorRegistry()
    registry.register(_Parts(parts.health))
    if parts.health.database == "ok":
        measures = measure(parts.registry.database, parts.settings.lease, time.time())
        registry.register(_Measures(measures, shutil.disk_usage(parts.settings.datasets).free))
    return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)


@router.get("/v1/audit", responses=problems(422))
def audit(_: Operator, stretch: Annotated[Stretch, Query()], parts: InParts) -> TrailDocument:
    """Who submitted, cancelled, pinned and deleted which job, who created and revoked which key."""
    deeds = trail(parts.registry.database, stretch.limit, stretch.before)
    more = len(deeds) == stretch.limit
    documents = [DeedDocument(**vars(deed) | {"time": datetime.fromtimestamp(deed.time, UTC)}) for deed in deeds]
    following = f"/v1/audit?limit={stretch.limit}&before={documents[-1].id}" if more else None
    return TrailDocument(deeds=documents, next=following)


class _Parts(Collector):
    """The parts of the service as Prometheus names them."""

    def __init__(self, health: Health) -> None:
        self._health = health

    def collect(self) -> Iterator[Metric]:
        health = self._health
        good = GaugeMetricFamily("hockle_part_ok", "1 where a part does its work, 0 where not", labels=["part"])
        for part in ("database", "broker", "disk", "workers", "leader"):
            good.add_metric([part], float(getattr(health, part) == "ok"))
        yield good
        still = GaugeMetricFamily("hockle_standing_still", "1 for each process, or part of one, that does not get on",
                                  labels=["process"])  # fmt: skip
        for name in health.silent:
            still.add_metric([name], 1.0)
        yield still
        ages = GaugeMetricFamily("hockle_process_age_seconds", "Since a process last got on", labels=["process"])
        for name, age in health.ages.items():
            ages.add_metric([name], age)
        yield ages


class _Measures(Collector):
    """Measures as Prometheus names them."""

    def __init__(self, measures: Measures, free: int) -> None:
        self._measures, self._free = measures, free

    def collect(self) -> Iterator[Metric]:
        measures = self._measures
        now = GaugeMetricFamily("hockle_jobs", "Jobs by status", labels=["status"])
        for status, count in measures.by_status.items():
            now.add_metric([status], count)
        ended = CounterMetricFamily("hockle_jobs_ended", "Ended jobs by outcome", labels=["status", "outcome"])
        for labels, count in measures.by_outcome.items():
            ended.add_metric(labels, count)
        yield from (now, ended)
        yield GaugeMetricFamily("hockle_queue_age_seconds", "Age of the oldest waiting job", measures.queue_age)
        yield GaugeMetricFamily("hockle_lease_age_seconds", "Since the most silent worker renewed", measures.lease_age)
        steps = measures.steps + measures.steps_redone  # the first alone falls where a run goes back to its checkpoint
        yield CounterMetricFamily("hockle_steps", "Steps of the solver, those computed again included", steps)
        yield CounterMetricFamily("hockle_steps_redone", "Steps lost and computed again", measures.steps_redone)
        sizes = GaugeMetricFamily("hockle_dataset_bytes", "Bytes of the datasets of an owner", labels=["owner"])
        for owner, size in measures.bytes.items():
            sizes.add_metric([owner], size)
        yield sizes
        yield GaugeMetricFamily("hockle_disk_free_bytes", "Free room where datasets are written", self._free)
        yield GaugeMetricFamily("hockle_datasets_lost", "Datasets that are missing or damaged", measures.lost)
        yield GaugeMetricFamily("hockle_jobs_pinned", "Jobs that nobody may delete", measures.pinned)
        yield CounterMetricFamily("hockle_jobs_deleted", "Jobs that were deleted, by whomever", measures.deleted)
        yield _histogram("hockle_drift_topology_turns", "|Tw + Wr - Lk| at the end of a run", measures.drift_topology)
        yield _histogram("hockle_drift_energy_ratio", "Energy balance at the end over the energy that changed its form",
                         measures.drift_energy)


def _histogram(name: str, text: str, of_methods: list[Histogram]) -> Metric:
    family = HistogramMetricFamily(name, text, labels=["method"])
    for histogram in of_methods:
        buckets = [(str(bound), float(below)) for bound, below in zip(BOUNDS, histogram.below, strict=True)]
        family.add_metric([histogram.method], [*buckets, ("+Inf", float(histogram.count))], histogram.total)
    return family
