"""The life of a job as a table. The names are those of OGC API Processes."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """Where a job is in its life."""

    ACCEPTED = "accepted"  # its row is committed; no worker has it
    RUNNING = "running"  # one worker holds its lease
    SUCCESSFUL = "successful"  # ran to its end; the dataset is there
    FAILED = "failed"  # stopped with a named outcome; the frames so far may be there
    DISMISSED = "dismissed"  # cancelled by its owner


TRANSITIONS: frozenset[tuple[Status, Status]] = frozenset({
    (Status.ACCEPTED, Status.RUNNING),  # claimed
    (Status.ACCEPTED, Status.DISMISSED),  # cancelled while no worker had it
    (Status.RUNNING, Status.ACCEPTED),  # handed back by its worker, or taken back from a lost one
    (Status.RUNNING, Status.SUCCESSFUL),
    (Status.RUNNING, Status.FAILED),  # by its worker, or by the reconciler after too many lost ones
    (Status.RUNNING, Status.DISMISSED),  # the worker, or the reconciler for a lost one, saw the cancel flag
})

ENDED: frozenset[Status] = frozenset(
    status for status in Status if not any(before is status for before, _ in TRANSITIONS)
)


def allowed_before(after: Status) -> list[Status]:
    """The states from which a job may go to `after`."""
    return [before for before, then in sorted(TRANSITIONS) if then is after]
