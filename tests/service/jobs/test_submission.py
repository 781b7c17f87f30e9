"""What comes of submissions: new jobs, those of an idempotency key, those that have run; many in one transaction."""

from __future__ import annotations

import threading
from concurrent.futures import wait

import pytest
from sqlalchemy import event

from service.jobs import Dataset, Job, NewJob, Reached, Registry, Status
from service.jobs.audit import Actor, trail
from service.jobs.held import claim
from service.jobs.reconciler import beats, take_back
from service.jobs.submission import ALIKE, REMEMBERED, KeyReused, QuotaReached, Submission, Terms, submit_all
from service.jobs.submissions import InFlight, Submissions

MANY = Terms(1000)
ALICE = Actor("alice", "0123456789ab")


def wanted(case=None, owner="alice", **terms):
    return Submission(NewJob(case or {"t_end": 1.0}, owner=owner), Actor(owner), **terms)


def submit(database, *submissions, terms=MANY):
    with database.writing() as transaction:
        return submit_all(transaction, submissions, terms)


def run(database, job, status=Status.SUCCESSFUL):
    held = claim(database, job.id, 9.0, "here")
    assert held.finish(status, "completed", "", Dataset("a.nc", "ab" * 32, 1), Reached(1.0, 1.0))


def test_each_submission_becomes_an_accepted_job(database, registry):
    made = submit(database, wanted(), wanted(), wanted(owner="bob"))
    assert [job.status for job in made] == [Status.ACCEPTED] * 3
    assert [registry.get(job.id) for job in made] == made
    assert [event.kind for event in registry.events(made[0].id)] == ["accepted"]


def test_the_same_key_and_body_give_the_same_job(database):
    [first] = submit(database, wanted(key="k", body_sha256="a"))
    again = submit(database, wanted(key="k", body_sha256="a"), wanted(key="k", body_sha256="a"))
    assert [job.id for job in again] == [first.id] * 2


def test_the_same_key_twice_in_one_transaction_makes_one_job(database, registry):
    made = submit(database, wanted(key="k", body_sha256="a"), wanted(key="k", body_sha256="a"))
    assert made[0] == made[1] and len(registry.page(9).jobs) == 1


def test_the_same_key_with_another_body_is_refused(database, registry):
    submit(database, wanted(key="k", body_sha256="a"))
    [refused] = submit(database, wanted(key="k", body_sha256="b"))
    assert isinstance(refused, KeyReused) and len(registry.page(9).jobs) == 1


def test_a_key_is_its_owners(database):
    alice, bob = submit(database, wanted(key="k", body_sha256="a"), wanted(key="k", body_sha256="b", owner="bob"))
    assert alice.id != bob.id


def test_a_key_outlives_clocks_that_are_wrong_by_a_day_either_way(database, clock):
    """Found by `python -m chaos`, seed 9: the clock went from a day behind to an hour ahead, and a retry made a job."""
    [first] = submit(database, wanted(key="k", body_sha256="a"))
    clock.now += 2 * 86400
    [again] = submit(database, wanted(key="k", body_sha256="a"))
    assert again.id == first.id


def test_a_key_is_forgotten_in_the_end(database, clock):
    [first] = submit(database, wanted(key="k", body_sha256="a"))
    clock.now += REMEMBERED + 1
    [second] = submit(database, wanted(key="k", body_sha256="b"))
    assert second.id != first.id


def test_a_successful_job_of_the_same_case_is_reused(database):
    [first] = submit(database, wanted(reuse=True))
    run(database, first)
    again, changed, fresh = submit(database, wanted(reuse=True), wanted({"t_end": 2.0}, reuse=True), wanted())
    assert again.id == first.id and again.status is Status.SUCCESSFUL
    assert len({first.id, changed.id, fresh.id}) == 3


def test_neither_an_unfinished_nor_a_failed_job_nor_anothers_is_reused(database):
    waiting, failed = submit(database, wanted(reuse=True), wanted(reuse=True))
    run(database, failed, Status.FAILED)
    theirs, mine = submit(database, wanted(owner="bob"), wanted(reuse=True))
    run(database, theirs)
    [last] = submit(database, wanted(reuse=True))
    assert len({waiting.id, failed.id, theirs.id, mine.id, last.id}) == 5


def test_whether_a_case_was_run_is_looked_up_by_the_case_however_many_jobs_there_are(database):
    submit(database, *(wanted({"t_end": float(i)}) for i in range(2000)), terms=Terms(10_000))
    with database.reading() as connection:
        statement = ALIKE.params(hashes=["0" * 64, "1" * 64])
        text = statement.compile(connection, compile_kwargs={"literal_binds": True})
        explain = "EXPLAIN QUERY PLAN" if connection.dialect.name == "sqlite" else "EXPLAIN"
        plan = "\n".join(str(row) for row in connection.exec_driver_sql(f"{explain} {text}"))
    assert "jobs_by_case" in plan and "jobs_by_end" not in plan and "jobs_listed" not in plan, plan


def test_a_quota_bounds_the_unfinished_jobs_of_an_owner(database):
    made = submit(database, wanted(), wanted(), wanted(), wanted(owner="bob"), terms=Terms(2))
    assert [type(one) for one in made] == [Job, Job, QuotaReached, Job]
    run(database, made[0])
    assert [type(one) for one in submit(database, wanted(), wanted(), terms=Terms(2))] == [Job, QuotaReached]


def test_a_job_counts_for_the_quota_until_it_has_ended_however_it_ends(database, registry):
    def room() -> int:
        with database.writing() as transaction:
            made = submit_all(transaction, [wanted() for _ in range(9)], terms=Terms(9))
            transaction.connection.rollback()
        return sum(isinstance(one, Job) for one in made)

    waiting, handed_back, lost, failed, dismissed = submit(database, *[wanted() for _ in range(5)])
    assert room() == 4
    claim(database, handed_back.id, 9.0, "here").release()
    claim(database, lost.id, 9.0, "here")
    take_back(database, beats(database)[0], attempts=3)
    assert room() == 4
    run(database, failed, Status.FAILED)
    registry.cancel(dismissed.id)
    registry.cancel(dismissed.id)
    assert room() == 6
    claim(database, lost.id, 9.0, "here")
    take_back(database, beats(database)[0], attempts=1)  # hopeless
    registry.cancel(waiting.id)
    assert room() == 8


def test_the_trail_tells_of_each_job_that_was_made(database):
    first, again = submit(database, *[Submission(NewJob({}), ALICE, key="k", body_sha256="a")] * 2)
    assert first == again
    assert [(deed.owner, deed.key, deed.action, deed.subject) for deed in trail(database, 9)] == [
        ("alice", ALICE.key, "job_submitted", first.id)
    ]


@pytest.fixture
def commits(database):
    """How many transactions have been committed."""
    seen: list[object] = []
    event.listen(database.engine, "commit", seen.append)
    return seen


def test_submissions_that_wait_together_share_a_transaction(database, commits):
    with Submissions(database, MANY, lambda: None) as submissions, database.writing():  # nobody else may write yet
        puts = [submissions.put(wanted()) for _ in range(50)]
        futures = [put.__enter__() for put in puts]
    wait(futures, 60)
    assert len({future.result().id for future in futures}) == 50
    assert len(commits) <= 4  # the one that held them up, those that were too early for the crowd, and the crowd


def test_a_key_in_flight_is_refused_and_afterwards_gives_its_job(database):
    with Submissions(database, MANY, lambda: None) as submissions:
        with submissions.put(wanted(key="k", body_sha256="a")) as first:
            with pytest.raises(InFlight), submissions.put(wanted(key="k", body_sha256="a")):
                pass
            made = first.result(60)
        with submissions.put(wanted(key="k", body_sha256="a")) as second:
            assert second.result(60).id == made.id


def test_the_same_key_from_many_threads_makes_one_job(database, registry):
    ids: list[str] = []

    def client(submissions: Submissions) -> None:
        while True:
            try:
                with submissions.put(wanted(key="k", body_sha256="a")) as future:
                    ids.append(future.result(60).id)
                    return
            except InFlight:
                continue

    with Submissions(database, MANY, lambda: None) as one, Submissions(database, MANY, lambda: None) as other:
        threads = [threading.Thread(target=client, args=(desk,)) for desk in (one, other) * 4]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert len(ids) == 8 and len(set(ids)) == 1 and len(registry.page(9).jobs) == 1


def test_one_that_cannot_be_written_harms_no_other(database):
    broken = Submission(NewJob({}, title=None), ALICE)
    with Submissions(database, MANY, lambda: None) as submissions, database.writing():
        puts = [submissions.put(one) for one in (wanted(), broken, wanted())]
        futures = [put.__enter__() for put in puts]
    wait(futures, 60)
    assert [future.exception() is None for future in futures] == [True, False, True]


def test_who_gave_up_before_the_commit_is_no_hindrance(database, registry):
    with Submissions(database, MANY, lambda: None) as submissions:
        with database.writing():
            futures = [submissions.put(wanted()).__enter__() for _ in range(5)]
            futures[-1].cancel()
        wait(futures, 60)
        assert futures[0].result().status is Status.ACCEPTED


def test_after_a_commit_it_is_told(database, until):
    told: list[int] = []
    with Submissions(database, MANY, lambda: told.append(1)) as submissions, submissions.put(wanted()) as future:
        future.result(60)
        until(lambda: told, "the commit is told of")


def test_a_telling_that_fails_is_not_the_last(database, until):
    told: list[int] = []

    def tell() -> None:
        told.append(1)
        if len(told) == 1:
            raise OSError("the database was away just then")

    with Submissions(database, MANY, tell) as submissions:
        for many in (1, 2):
            with submissions.put(wanted()) as future:
                future.result(60)
            until(lambda many=many: len(told) == many, "the commit is told of")


def test_an_owner_sees_no_others_jobs(database, registry):
    alice, bob = submit(database, wanted(), wanted(owner="bob"))
    bobs = registry.of("bob")
    assert [job.id for job in bobs.page(9).jobs] == [bob.id]
    assert bobs.events(alice.id) == [] and bobs.versions([alice.id, bob.id]) == {bob.id: 1}
    for method in (bobs.get, bobs.case, bobs.cancel):
        with pytest.raises(LookupError):
            method(alice.id)
    assert registry.get(alice.id) == alice
    assert isinstance(registry, Registry)


def test_the_idempotency_keys_of_an_owner_are_bounded_even_if_they_make_no_job(database, clock, monkeypatch):
    monkeypatch.setattr("service.jobs.submission.MOST_KEYS", 2)
    [first] = submit(database, wanted(reuse=True, key="1", body_sha256="a"))
    run(database, first)
    again, refused, keyless, other = submit(
        database, wanted(reuse=True, key="2", body_sha256="a"), wanted(reuse=True, key="3", body_sha256="a"),
        wanted(reuse=True), wanted(key="1", body_sha256="a", owner="bob"),
    )  # fmt: skip
    assert again.id == keyless.id == first.id and other.owner == "bob"
    assert isinstance(refused, QuotaReached) and "alice has 2 idempotency keys" in str(refused)
    assert submit(database, wanted(key="1", body_sha256="a"))[0].id == first.id
    clock.now += REMEMBERED + 1
    assert isinstance(submit(database, wanted(key="3", body_sha256="a"))[0], Job)
