"""hockle keys: a key is shown once, listed without its secret, and revoked by its prefix."""

from __future__ import annotations

import re

import pytest

from hockle.cli import main


@pytest.fixture
def keys(tmp_path, capsys):
    def run(*words: str) -> tuple[int, str, str]:
        status = main(["keys", words[0], "--data", str(tmp_path), *words[1:]])
        return status, *capsys.readouterr()

    return run


def test_a_key_is_made_listed_and_revoked(keys):
    status, text, _ = keys("create", "alice", "--scopes", "read", "--days", "2")
    assert status == 0 and re.fullmatch(r"hk_[0-9a-f]{12}_[A-Za-z0-9_-]{43}\n", text)
    prefix, secret = text.strip().split("_", 2)[1:]
    _, listed, _ = keys("list")
    assert prefix in listed and secret not in listed
    assert listed.split()[1:3] == ["alice", "read"] and listed.split()[-1] == "good"
    assert keys("revoke", prefix)[0] == 0
    assert keys("list")[1].split()[-1] == "revoked"


@pytest.mark.parametrize(("words", "told"), [
    (("create", "Alice!"), "owner must be"), (("create", "alice", "--scopes", "admin"), "--scopes takes some of"),
    (("create", "alice", "--scopes", ""), "--scopes takes some of"), (("revoke", "0123"), "no key has the prefix"),
    (("create", "alice", "--days", "0"), "--days must"), (("create", "alice", "--days", "nan"), "--days must"),
])  # fmt: skip
def test_what_cannot_be_done_is_told_in_a_sentence(keys, words, told):
    status, _, error = keys(*words)
    assert status == 1 and told in error


def test_another_host_is_served_only_with_a_key(tmp_path):
    from hockle.failure import Failure
    from hockle.supervisor import Services
    from service.settings import Settings

    with pytest.raises(Failure, match="hockle keys create"):
        Services(Settings(data=tmp_path), host="0.0.0.0", port=0).__enter__()
