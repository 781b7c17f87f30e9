"""A key names its owner and opens nothing for anybody else; its secret is kept by nobody."""

from __future__ import annotations

import time

import pytest

from service.access import LOCAL, KeyStore, NewKey, Refused, Scope, UnknownKey, authenticate
from service.jobs import Database
from service.jobs.audit import trail

HOUR = 3600.0
BOTH = frozenset({Scope.READ, Scope.SUBMIT})


class Clock:
    now = 1e9

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def database(tmp_path, tables, clock):
    database = Database(f"sqlite:///{tmp_path}/registry.db", clock)
    yield database
    database.close()


@pytest.fixture
def store(database):
    return KeyStore(database)


def caller(store, text, now, required=True):
    return authenticate(f"Bearer {text}", store.find, required, now)


def test_a_key_names_its_owner_and_scopes(store, clock):
    new = store.create("alice", BOTH, HOUR)
    told = caller(store, new.text, clock.now)
    assert (told.owner, told.scopes, told.key) == ("alice", BOTH, new.prefix)


def test_a_secret_has_256_bits_and_is_not_in_the_database(store, database, tmp_path):
    new = store.create("alice", BOTH, HOUR)
    assert len(new.secret) == 43  # 32 bytes in base64
    database.close()
    stored = b"".join(path.read_bytes() for path in tmp_path.iterdir())
    assert new.prefix.encode() in stored and new.secret.encode() not in stored
    assert new.secret not in repr(new) and new.secret not in repr(store.find(new.prefix))


def test_no_two_keys_are_alike(store):
    made = [store.create("alice", BOTH, HOUR) for _ in range(20)]
    assert len({key.prefix for key in made}) == len({key.secret for key in made}) == 20


def test_an_expired_key_is_refused(store, clock):
    new = store.create("alice", BOTH, HOUR)
    caller(store, new.text, clock.now + HOUR - 1)
    with pytest.raises(Refused):
        caller(store, new.text, clock.now + HOUR)


def test_a_revoked_key_is_refused_from_then_on(store, clock):
    new, other = store.create("alice", BOTH, HOUR), store.create("alice", BOTH, HOUR)
    store.revoke(new.prefix)
    with pytest.raises(Refused):
        caller(store, new.text, clock.now)
    assert caller(store, other.text, clock.now).owner == "alice"


def test_revoking_twice_is_fine_and_revoking_what_is_not_there_is_told(store):
    new = store.create("alice", BOTH, HOUR)
    store.revoke(new.prefix)
    store.revoke(new.prefix)
    with pytest.raises(UnknownKey):
        store.revoke("0" * 12)


def test_the_prefix_of_one_with_the_secret_of_another_is_refused(store, clock):
    alice, bob = store.create("alice", BOTH, HOUR), store.create("bob", BOTH, HOUR)
    with pytest.raises(Refused):
        caller(store, f"hk_{alice.prefix}_{bob.secret}", clock.now)


def test_what_is_wrong_with_a_key_is_not_told(store, clock):
    new = store.create("alice", BOTH, HOUR)
    store.revoke(new.prefix)
    told = set()
    for text in (new.text, NewKey("alice", BOTH, 0.0).text, f"hk_{new.prefix}_{'x' * 43}"):
        with pytest.raises(Refused) as refused:
            caller(store, text, clock.now)
        told.add(str(refused.value))
    assert len(told) == 1


@pytest.mark.parametrize("header", [
    "", "Bearer", "Bearer ", "Bearer x", "Basic aGs6aGs=", "hk_0123456789ab_" + "x" * 43,
    "Bearer hk_0123456789ab_" + "x" * 42, "Bearer hk_0123456789ab_" + "x" * 44, "Bearer hk_0123456789AB_" + "x" * 43,
    "Bearer hk_0123456789ab_" + "x" * 42 + "\u00e9", "Bearer hk_" + "' OR 1=1 --".ljust(12) + "_" + "x" * 43,
])
@pytest.mark.parametrize("required", [True, False])
def test_what_is_no_key_is_refused_even_where_none_is_required(store, header, required):
    with pytest.raises(Refused):
        authenticate(header, store.find, required, time.time())


def test_without_a_key_one_is_local_or_refused(store):
    assert authenticate(None, store.find, False, 0.0) is LOCAL
    with pytest.raises(Refused, match="required"):
        authenticate(None, store.find, True, 0.0)


@pytest.mark.parametrize("owner", ["", "local", "Alice", "a" * 64, "a b", "../etc", "-a", "a\n"])
def test_an_owner_has_a_plain_name(owner):
    with pytest.raises(ValueError, match="owner must be"):
        NewKey(owner, BOTH, 0.0)


def test_a_key_needs_a_scope(store):
    with pytest.raises(ValueError, match="scopes must be"):
        store.create("alice", frozenset(), HOUR)


def test_there_are_keys_while_one_is_good(store, clock):
    assert not store.any_good(clock.now)
    new = store.create("alice", BOTH, HOUR)
    assert store.any_good(clock.now) and not store.any_good(clock.now + HOUR)
    store.revoke(new.prefix)
    assert not store.any_good(clock.now)


def test_the_trail_tells_of_keys_made_and_revoked(store, database):
    new = store.create("alice", BOTH, HOUR)
    store.revoke(new.prefix)
    assert [(deed.action, deed.subject) for deed in trail(database, 10)] == [
        ("key_revoked", new.prefix), ("key_created", new.prefix),
    ]  # fmt: skip
