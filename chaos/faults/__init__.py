"""The faults, each a function that tells whether it could be done now."""

from __future__ import annotations

from chaos.faults.broker import (
    delay_message,
    double_messages,
    fill_broker,
    kill_broker,
    lose_message,
    stall_broker,
    wipe_broker,
)
from chaos.faults.database import (
    cancel_at_end,
    cancel_job,
    fill_disk_of_database,
    lock_database,
    restart_database,
)
from chaos.faults.files import (
    fill_disk,
    fill_disk_at_consolidation,
    tear_checkpoint,
)
from chaos.faults.processes import (
    jump_clock,
    kill_api,
    kill_api_after_commit,
    kill_api_before_commit,
    kill_at_rename,
    kill_child,
    kill_supervisor,
    kill_worker,
    stop_api_past_its_lease,
    stop_child_for_a_moment,
    stop_child_past_its_lease,
    stop_gracefully,
    stop_worker_past_its_lease,
)
from chaos.faults.target import Fault, Target

WEIGHTS: dict[Fault, int] = {
    kill_child: 20, stop_child_past_its_lease: 5, stop_worker_past_its_lease: 1, stop_child_for_a_moment: 6,
    stop_api_past_its_lease: 1, kill_worker: 1, kill_api: 2, kill_api_before_commit: 1, kill_api_after_commit: 1,
    kill_supervisor: 1, stop_gracefully: 1, kill_broker: 2, stall_broker: 2, wipe_broker: 6, fill_broker: 2,
    lose_message: 6, double_messages: 6, delay_message: 2, tear_checkpoint: 4, kill_at_rename: 5, cancel_at_end: 2,
    jump_clock: 3, fill_disk: 2, fill_disk_at_consolidation: 2, fill_disk_of_database: 1, lock_database: 2,
    restart_database: 2, cancel_job: 3,
}  # fmt: skip
"""How often each fault is done: seldom what costs seconds of starting processes again."""

__all__ = ["WEIGHTS", "Fault", "Target"]
