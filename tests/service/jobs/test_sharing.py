"""Workers are shared out between owners, also while jobs run: one that runs for long gives way to others."""

from __future__ import annotations

import re
import threading
from typing import Any

import pytest
from sqlalchemy import event

from service.jobs import Database, NewJob, Reached, Registry, Status
from service.jobs.audit import Actor, trail
from service.jobs.held import HeldJob, Wish, claim
from service.jobs.pauses import drain, pause, paused, resume
from service.jobs.registry import insert_jobs
from service.jobs.sharing import PATIENCE, Running, choose, make_room, next_in_turn

LEASE, TURN = 10.0, 30.0
FEW = 10
BOSS = Actor("boss", "abc")


def running(*owners: str, since: float = 0.0, gives_way: bool = False) -> list[Running]:
    return [Running(f"{owner}{number}", owner, since + number, gives_way) for number, owner in enumerate(owners)]


@pytest.mark.parametrize(("waiting", "now", "chosen"), [
    (["b"], running("a", "a"), ["a0"]),  # the longest of who has the most
    (["b"], running("a", "c", "a", "c", "c"), ["c1"]),
    (["b"], running("a"), ["a0"]),  # also where there is one worker only
    (["a"], running("a", "a"), []),  # one's own jobs do not give way to each other
    (["b"], running("a", "a", "b"), []),  # nobody would have less more than another
    (["b"], running("a", "a", "a", "b"), ["a0"]),
    (["b", "c"], running("a", "a", "a"), ["a0", "a1"]),
    (["b", "c"], running("a", "a"), ["a0", "a1"]),
    (["b"], running("a", "a", since=100.0), []),  # they have not had their turn yet
    (["b"], [*running("a"), *running("c", gives_way=True)], []),  # a place is about to be free
    (["b", "d"], [*running("a"), *running("c", gives_way=True)], ["a0"]),
    ([], running("a", "a"), []),
])  # fmt: skip
def test_who_gives_way_to_whom(waiting, now, chosen):
    assert choose(waiting, now, before=50.0) == chosen


def test_nobody_gives_way_to_an_owner_who_may_have_no_more():
    assert choose(["b"], running("a", "a", "a", "b"), before=50.0, most=1) == []


def held(registry: Registry, owner: str, worker: str = "here:1", most: int | None = None) -> HeldJob | None:
    return claim(registry.database, registry.submit(NewJob({}, owner=owner)).id, LEASE, worker, most)


def test_a_long_job_is_told_to_give_way_once_its_turn_is_over_and_its_owner_is_served_last(registry, clock):
    long = held(registry, "a")
    more = registry.submit(NewJob({}, owner="a"))
    short = registry.submit(NewJob({}, owner="b"))
    for passed, wish in ((0.0, Wish.GO_ON), (TURN - 1, Wish.GO_ON), (TURN + 1, Wish.GIVE_WAY)):
        clock.now = 1_000.0 + passed
        make_room(registry.database, TURN, None, clock.now)
        assert long.renew(LEASE, Reached(0.5)) is wish
    long.release()
    assert registry.get(long.job.id).attempts == 0
    assert next_in_turn(registry.database) == short.id
    claim(registry.database, short.id, LEASE, "here:1").finish(Status.SUCCESSFUL, "completed", "", None, Reached())
    assert next_in_turn(registry.database) == long.job.id < more.id
    again = claim(registry.database, long.job.id, LEASE, "here:1")
    assert again.renew(LEASE, Reached(0.5)) is Wish.GO_ON


def test_two_long_jobs_of_owners_with_one_worker_change_places_once_a_turn(registry, clock):
    first, second = held(registry, "a"), registry.submit(NewJob({}, owner="b"))
    served = []
    for _ in range(4):
        served.append(first.job.owner)
        clock.now += PATIENCE + 1
        make_room(registry.database, TURN, None, clock.now)
        assert first.renew(LEASE, Reached()) is Wish.GO_ON
        clock.now += TURN
        make_room(registry.database, TURN, None, clock.now)
        assert first.renew(LEASE, Reached()) is Wish.GIVE_WAY
        first.release()
        first = claim(registry.database, next_in_turn(registry.database), LEASE, "here:1")
    assert served == ["a", "b", "a", "b"]
    assert second.owner == "b"


def test_an_owner_has_no_more_running_than_he_may(registry):
    jobs = [registry.submit(NewJob({}, owner="a")).id for _ in range(6)]
    other = registry.submit(NewJob({}, owner="b")).id
    won: list[HeldJob] = []

    def try_to_claim(job_id: str) -> None:
        if taken := claim(registry.database, job_id, LEASE, "here:1", most=2):
            won.append(taken)

    threads = [threading.Thread(target=try_to_claim, args=(job_id,)) for job_id in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(won) == 2
    assert next_in_turn(registry.database, most=2) == other
    assert next_in_turn(registry.database, [other], most=2) is None
    assert next_in_turn(registry.database, [other]) is not None


def test_while_all_is_paused_nobody_takes_a_job_and_what_runs_goes_on(registry):
    job, runs = registry.submit(NewJob({})), held(registry, "a")
    pause(registry.database, "", False, BOSS)
    assert next_in_turn(registry.database, host="here") is None
    assert claim(registry.database, job.id, LEASE, "here:1") is None
    drain(registry.database)
    assert runs.renew(LEASE, Reached()) is Wish.GO_ON
    assert resume(registry.database, "", BOSS)
    assert not resume(registry.database, "", BOSS)
    assert claim(registry.database, job.id, LEASE, "here:1") is not None
    assert [(deed.owner, deed.action) for deed in trail(registry.database, 2)] == \
        [("boss", "queue_resumed"), ("boss", "queue_paused")]  # fmt: skip


def test_a_host_that_is_drained_hands_back_what_it_runs_and_another_takes_it(registry):
    here, like_here, there = (held(registry, "a", worker) for worker in ("node_1:7", "node11:7", "there:7"))
    pause(registry.database, "node_1", True, BOSS)
    wishes = [one.renew(LEASE, Reached()) for one in (here, like_here, there)]
    assert wishes == [Wish.GIVE_WAY, Wish.GO_ON, Wish.GO_ON]
    here.release()
    assert next_in_turn(registry.database, host="node_1") is None
    assert claim(registry.database, here.job.id, LEASE, "node_1:8") is None
    assert next_in_turn(registry.database, host="there") == here.job.id
    assert [(one.host, one.drains, one.owner) for one in paused(registry.database)] == [("node_1", True, "boss")]


def test_a_job_that_was_claimed_while_its_host_began_to_drain_is_handed_back_too(registry):
    pause(registry.database, "here", True, BOSS)
    late = held(registry, "a", "there:1")
    with registry.database.writing() as transaction:
        transaction.change(worker="here:1")
    assert late.renew(LEASE, Reached()) is Wish.GO_ON
    drain(registry.database)
    assert late.renew(LEASE, Reached()) is Wish.GIVE_WAY


def test_a_choice_reads_few_jobs_however_many_wait(server):
    """On PostgreSQL, which has counted none of them yet: by SQLite's plan nothing of this can be seen."""
    database = Database(server.create("choices"))
    jobs = [NewJob({"t_end": float(number)}, owner="alice") for number in range(2000)]
    with database.writing() as transaction:
        insert_jobs(transaction, jobs)
    statements: list[tuple[str, Any]] = []
    with database.reading() as connection:
        engine = connection.engine
    event.listen(engine, "before_cursor_execute", lambda *given: statements.append((given[2], given[3])))
    assert next_in_turn(database) == min(job.id for job in jobs)
    with database.reading() as connection:
        plan = "\n".join(row[0] for row in connection.exec_driver_sql(f"EXPLAIN ANALYZE {statements[0][0]}",
                                                                      statements[0][1]))  # fmt: skip
    database.close()
    assert all(int(rows) < FEW for rows in re.findall(r"actual time=\S+ rows=(\d+)", plan)), plan
