"""One job from claim to end: every way it can end leaves a row that says so, and no half dataset."""

from __future__ import annotations

import errno
import hashlib
import itertools
import logging
import os
import signal
import threading
import time
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy.exc import OperationalError

from service.jobs import Job, Limits, NewJob, Registry, Selection, Status
from service.jobs.held import HeldJob, Wish, claim
from service.jobs.measures import measure
from service.jobs.sharing import make_room
from service.results import Datasets, DatasetWriter, open_dataset, segments
from service.results.segments import Segments
from service.settings import Settings
from solver import Outcome, RunFailed, simulate
from worker import attempt, checkpoints, lease, run
from worker.lock import job_lock


def ended(job: Job, registry: Registry, settings: Settings) -> Job:
    run.run_next(registry.database, settings)
    return registry.get(job.id)


def left_over(settings: Settings) -> list[Path]:
    return [*settings.datasets.iterdir(), *settings.locks.iterdir(), *settings.work.iterdir()]


def simulation_that(does, at_frame: int = 2):
    """The real simulation, to which something happens at one of its frames."""

    def begin(scene):
        real = simulate(scene)
        advance, number = real.advance, itertools.count()

        def watched():
            frame = advance()
            if frame is not None and next(number) == at_frame:
                does()
            return frame

        real.advance = watched
        return real

    return begin


def raising(error: BaseException):
    def raise_it(*_, **__):
        raise error

    return raise_it


def test_a_job_ends_with_a_dataset_whose_hash_its_row_tells(job, registry, settings):
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.progress) == (Status.SUCCESSFUL, "completed", 1.0)
    path = settings.datasets / done.dataset.file
    assert hashlib.sha256(path.read_bytes()).hexdigest() == done.dataset.sha256
    assert path.stat().st_size == done.dataset.bytes
    with open_dataset(path) as dataset:
        assert dataset.attrs["outcome"] == "completed"
        assert float(dataset.time[-1]) == pytest.approx(0.05)
    assert left_over(settings) == [path]


def test_a_job_says_what_its_dataset_says_of_the_run(registry, settings, case):
    numerics = {name: value for name, value in case["numerics"].items() if name in ("method", "rho_inf")}
    case |= {"numerics": {**numerics, "tolerance": 0.02}}
    done = ended(registry.submit(NewJob(case)), registry, settings)
    with open_dataset(settings.datasets / done.dataset.file) as dataset:
        assert {name: dataset.attrs[name] for name in done.attributes} == done.attributes
    assert done.attributes["tolerance"] == 0.02 and "tolerance_met" in done.attributes and "error_r" in done.attributes


def test_the_registry_learns_how_far_a_run_has_drifted(registry, settings, case):
    ended(registry.submit(NewJob(case)), registry, settings)
    told = measure(registry.database, 1.0, 0.0)
    (topology,), (energy,) = told.drift_topology, told.drift_energy
    assert (topology.method, topology.count, energy.method, energy.count) == ("box", 1, "box", 1)
    assert topology.total < 1e-3  # its twist and writhe hardly change, and Lk not at all
    assert 0.0 < energy.total < 1.0  # of a coarse mesh, but no more than there is


def test_a_run_that_takes_many_times_its_estimate_ends_by_name_and_keeps_its_frames(
    job, registry, settings, monkeypatch
):
    monkeypatch.setattr(attempt, "LEAST_BUDGET", 0.0)
    real = simulate

    def begin(scene):
        simulation = real(scene)
        advance = simulation.advance

        def slow():
            frame = advance()
            if frame is not None and frame.t > 0.025:
                simulation.statistics.cpu_time += 1000.0
            return frame

        simulation.advance = slow
        return simulation

    monkeypatch.setattr(attempt, "simulate", begin)
    done = ended(job, registry, settings)
    assert (done.status, done.outcome) == (Status.FAILED, "estimate_exceeded")
    assert "of computing" in done.message and "dt_max" in done.message
    with open_dataset(settings.datasets / done.dataset.file) as dataset:
        assert float(dataset.time[-1]) == pytest.approx(0.03)


@pytest.mark.parametrize(("overrun", "outcome"), [(20.0, "completed"), (1e-9, "estimate_exceeded")])
def test_how_many_times_is_the_operators_to_say(job, registry, settings, monkeypatch, overrun, outcome):
    assert ended(job, registry, replace(settings, overrun=overrun)).outcome == "completed"  # less than a minute
    monkeypatch.setattr(attempt, "LEAST_BUDGET", 0.0)
    again = registry.submit(NewJob(registry.case(job.id)))
    assert ended(again, registry, replace(settings, overrun=overrun)).outcome == outcome


def test_a_message_that_comes_twice_does_nothing(job, registry, settings):
    assert ended(job, registry, settings) == ended(job, registry, settings)


def test_a_message_without_a_waiting_job_does_nothing(registry, settings):
    run.run_next(registry.database, settings)
    assert left_over(settings) == []


def test_a_job_whose_lock_another_process_holds_is_left_alone(job, registry, settings, case):
    with job_lock(settings.locks / f"{job.id}.lock") as mine:
        assert mine
        other = registry.submit(NewJob(case))
        assert ended(other, registry, settings).status is Status.SUCCESSFUL
        assert registry.get(job.id).status is Status.ACCEPTED


def test_a_lock_file_that_its_holder_removed_meanwhile_locks_nothing(settings):
    path = settings.locks / "x.lock"
    with job_lock(path) as first:
        assert first
        path.unlink()
        with job_lock(path) as second:
            assert second
            path.unlink()
            path.touch()
            with job_lock(path) as third:
                assert third


def test_a_full_disk_takes_no_job_from_who_only_marks_its_steps(settings, monkeypatch):
    with job_lock(settings.locks / "x.lock") as held:
        monkeypatch.setattr(os, "pwrite", raising(OSError(errno.ENOSPC, "No space left on device")))
        held.mark(7)


def test_a_run_that_fails_keeps_its_frames_and_tells_the_remedy(job, registry, settings, monkeypatch):
    failure = RunFailed(Outcome.STEP_TOO_SMALL, 0.02, 7, "stuck")
    monkeypatch.setattr(attempt, "simulate", simulation_that(raising(failure)))
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.message) == (Status.FAILED, "step_too_small", str(failure))
    with open_dataset(settings.datasets / done.dataset.file) as dataset:
        assert dataset.sizes["time"] == 2
        assert dataset.attrs["outcome"] == "step_too_small"


def test_a_job_cancelled_while_it_runs_leaves_nothing(job, registry, settings, monkeypatch, until):
    seen: list[Wish | None] = []
    renew = HeldJob.renew

    def watched(self, *told):
        seen.append(renew(self, *told))
        return seen[-1]

    def cancel():
        registry.cancel(job.id)
        until(lambda: seen.count(Wish.CANCEL) > 1, "the lease brings the wish, and a renewal later it is judged")

    monkeypatch.setattr(lease, "RENEWAL", 0.01)
    monkeypatch.setattr(HeldJob, "renew", watched)
    monkeypatch.setattr(attempt, "simulate", simulation_that(cancel))
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.dataset) == (Status.DISMISSED, "cancelled", None)
    assert left_over(settings) == []


def test_a_job_cancelled_after_its_last_step_leaves_nothing(job, registry, settings, monkeypatch):
    publish = Datasets.publish

    def cancelled(self, path):
        publish(self, path)
        registry.cancel(job.id)

    monkeypatch.setattr(Datasets, "publish", cancelled)
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.dataset) == (Status.DISMISSED, "cancelled", None)
    assert left_over(settings) == []


def test_a_job_that_runs_too_long_ends_by_name(registry, settings, monkeypatch, until, case):
    job = registry.submit(NewJob(case, limits=Limits(wall=0.05)))

    def dawdle():
        until(lambda: registry.get(job.id).reached.wall > 0.1, "a renewal tells the time")
        time.sleep(0.1)

    monkeypatch.setattr(lease, "RENEWAL", 0.01)
    monkeypatch.setattr(attempt, "simulate", simulation_that(dawdle))
    done = ended(job, registry, settings)
    assert (done.status, done.outcome) == (Status.FAILED, "wall_time_exceeded")


def test_an_end_is_written_though_the_database_was_away(job, registry, settings, monkeypatch):
    finish, failures = HeldJob.finish, iter([OperationalError("x", {}, Exception("away"))] * 2)

    def sometimes(self, *told):
        for failure in failures:
            raise failure
        return finish(self, *told)

    monkeypatch.setattr(HeldJob, "finish", sometimes)
    done = ended(job, registry, settings)
    assert done.status is Status.SUCCESSFUL
    assert left_over(settings) == [settings.datasets / done.dataset.file]


def test_a_job_begins_again_though_the_database_is_away_just_then(job, registry, settings, monkeypatch):
    claim(registry.database, job.id, 9.0, "a worker that hands it back").release()
    renew = HeldJob.renew

    def only_from_its_own_thread(self, *told):
        if threading.current_thread() is threading.main_thread():
            raise OperationalError("x", {}, Exception("database or disk is full"))
        return renew(self, *told)

    monkeypatch.setattr(HeldJob, "renew", only_from_its_own_thread)
    done = ended(job, registry, settings)
    assert (done.status, done.epoch) == (Status.SUCCESSFUL, 2)


WRITES = [(Path, "mkdir"), (Segments, "flush"), (DatasetWriter, "publish")]


@pytest.mark.parametrize(("written", "method"), WRITES)
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_a_disk_that_stays_full_has_a_name_and_leaves_nothing(job, registry, settings, monkeypatch, written, method,
                                                              number):
    monkeypatch.setattr(segments, "SEGMENT_BYTES", 1)
    monkeypatch.setattr(attempt, "ROOM_WITHIN", 0.0)
    monkeypatch.setattr(written, method, raising(OSError(number, "No space left on device")))
    done = ended(job, registry, settings)
    assert (done.status, done.outcome, done.dataset) == (Status.FAILED, "disk_full", None)
    assert "make room" in done.message
    assert left_over(settings) == []


@pytest.mark.parametrize(("written", "method"), WRITES)
def test_a_disk_that_is_full_for_a_while_costs_nothing(job, registry, settings, monkeypatch, written, method):
    write, failures = getattr(written, method), iter([OSError(errno.ENOSPC, "No space left on device")] * 3)

    def at_last(self, *told, **named):
        for failure in failures:
            raise failure
        return write(self, *told, **named)

    monkeypatch.setattr(segments, "SEGMENT_BYTES", 1)
    monkeypatch.setattr(attempt, "LOOK_AGAIN", 0.0)
    monkeypatch.setattr(written, method, at_last)
    done = ended(job, registry, settings)
    assert (done.status, done.attempts) == (Status.SUCCESSFUL, 1)
    with open_dataset(settings.datasets / done.dataset.file) as dataset:
        assert dataset.sizes["time"] == 6


def test_a_disk_that_has_room_again_when_it_is_looked_at_costs_nothing(job, registry, settings, monkeypatch):
    publish, failures = DatasetWriter.publish, iter([OSError(errno.EIO, "NetCDF: HDF error")])

    def at_last(self, *told):
        for failure in failures:
            raise failure
        return publish(self, *told)

    monkeypatch.setattr(attempt, "LOOK_AGAIN", 0.0)
    monkeypatch.setattr(DatasetWriter, "publish", at_last)
    assert ended(job, registry, settings).status is Status.SUCCESSFUL


def test_another_fault_of_the_disk_is_not_called_full(job, registry, settings, monkeypatch):
    monkeypatch.setattr(attempt, "LOOK_AGAIN", 0.0)
    monkeypatch.setattr(DatasetWriter, "publish", raising(OSError(errno.EIO, "Input/output error")))
    done = ended(job, registry, settings)
    assert (done.status, done.outcome) == (Status.FAILED, "dataset_not_written")
    assert "Input/output error" in done.message


def test_a_bug_is_told_without_its_traceback_which_is_logged(job, registry, settings, monkeypatch, caplog):
    monkeypatch.setattr(attempt, "simulate", raising(ZeroDivisionError("secret detail")))
    with caplog.at_level(logging.ERROR):
        done = ended(job, registry, settings)
    assert (done.status, done.outcome) == (Status.FAILED, "internal_error")
    assert "ZeroDivisionError" in done.message and "secret detail" not in done.message
    assert "secret detail" in caplog.text


def test_too_little_memory_has_a_name(job, registry, settings, monkeypatch):
    monkeypatch.setattr(attempt, "simulate", raising(MemoryError()))
    assert ended(job, registry, settings).outcome == "out_of_memory"


def test_memory_that_ends_while_a_checkpoint_is_packed_has_the_same_name(job, registry, settings, monkeypatch):
    """A BytesIO that cannot grow has lost its buffer, and is closed: so closing the archive in it is a ValueError."""

    class Narrow(BytesIO):
        def write(self, content):
            if self.tell() + len(content) > 10_000:
                self.close()
                raise MemoryError
            return super().write(content)

    monkeypatch.setattr(checkpoints, "BytesIO", Narrow)
    with pytest.raises(ValueError, match="closed"):
        np.savez(Narrow(), np.zeros(10_000))
    assert ended(job, registry, replace(settings, checkpoint=1e-9)).outcome == "out_of_memory"


def test_a_case_that_this_version_refuses_fails_with_its_faults(registry, settings, case):
    done = ended(registry.submit(NewJob(case | {"t_end": -1})), registry, settings)
    assert (done.status, done.outcome) == (Status.FAILED, "invalid_case")
    assert "t_end" in done.message


def test_a_worker_told_to_stop_hands_its_job_back_and_the_next_one_goes_on(job, registry, settings, monkeypatch):
    with monkeypatch.context() as interrupted:
        interrupted.setattr(attempt, "simulate", simulation_that(lambda: os.kill(os.getpid(), signal.SIGTERM)))
        with pytest.raises(SystemExit):
            run.run_next(registry.database, settings)
    waiting = registry.get(job.id)
    assert (waiting.status, waiting.attempts) == (Status.ACCEPTED, 0)
    assert list(settings.datasets.iterdir()) == []
    done = ended(job, registry, settings)
    assert (done.status, done.attempts, done.reached.steps_redone) == (Status.SUCCESSFUL, 1, 0)
    assert left_over(settings) == [settings.datasets / done.dataset.file]


def test_a_long_job_gives_way_to_anothers_and_ends_to_the_bit_as_if_it_had_not(registry, settings, case, monkeypatch):
    undisturbed = ended(registry.submit(NewJob(case, owner="carol")), registry, settings)
    long = registry.submit(NewJob(case, owner="alice"))

    def others_come():
        registry.submit(NewJob(case, owner="bob"))
        make_room(registry.database, 0.0, None, time.time() + 1000.0)

    tell = lease.Lease.tell

    def tell_and_renew(self, reached):
        tell(self, reached)
        self.renew()

    with monkeypatch.context() as interrupted:
        interrupted.setattr(lease.Lease, "tell", tell_and_renew)
        interrupted.setattr(attempt, "simulate", simulation_that(others_come))
        assert run.run_next(registry.database, settings)
    waiting = registry.get(long.id)
    assert (waiting.status, waiting.attempts) == (Status.ACCEPTED, 0)
    assert 0.0 < waiting.progress < 1.0
    assert run.run_next(registry.database, settings)
    assert [job.status for job in registry.page(9, Selection(owner="bob")).jobs] == [Status.SUCCESSFUL]
    done = ended(long, registry, settings)
    assert (done.status, done.attempts, done.reached.steps_redone) == (Status.SUCCESSFUL, 1, 0)
    with (open_dataset(settings.datasets / done.dataset.file) as one,
          open_dataset(settings.datasets / undisturbed.dataset.file) as two):  # fmt: skip
        for name in one.variables:
            np.testing.assert_array_equal(one[name].values, two[name].values, err_msg=name)


def test_a_worker_that_lost_its_job_writes_nothing_for_it(job, registry, settings, monkeypatch, take_back_all):
    def give_away():
        take_back_all()

    monkeypatch.setattr(attempt, "simulate", simulation_that(give_away))
    run.run_next(registry.database, settings)
    held = registry.get(job.id)
    assert (held.status, held.epoch, held.dataset) == (Status.ACCEPTED, 2, None)
    assert left_over(settings) == [settings.work / job.id]  # for who has it next


def test_what_was_left_of_a_job_that_ended_without_a_worker_is_removed(job, registry, settings, take_back_all):
    (settings.work / job.id).mkdir()
    (settings.work / job.id / "checkpoint-1.1").write_bytes(b"x")
    (settings.locks / f"{job.id}.lock").touch()
    claim(registry.database, job.id, 9.0, "here")
    (settings.datasets / f"{job.id}.1.nc").write_bytes(b"published, but never told")
    registry.cancel(job.id)
    take_back_all()
    run.run_next(registry.database, settings)
    assert left_over(settings) == []
