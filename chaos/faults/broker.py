"""Redis dies, is silent, forgets, has no room; messages are lost, late, or come twice."""

from __future__ import annotations

import signal
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import redis

from chaos.faults.target import Target
from chaos.served import send, wait_for
from service.jobs.doorbell import QUEUE

FULL = 1.0
"""Seconds for which it has no room."""


def kill_broker(target: Target) -> bool:
    """kill -9 of Redis."""
    return send(target.served.broker(), signal.SIGKILL)


def stall_broker(target: Target) -> bool:
    """Redis answers nothing for a while, which may be longer than anybody waits for it."""
    pid = target.served.broker()
    if not send(pid, signal.SIGSTOP):
        return False
    target.in_a_while(target.random.uniform(0.5, 8.0), lambda: send(pid, signal.SIGCONT))
    return True


def _with_broker(target: Target, command: Callable[[redis.Redis], object]) -> bool:
    client = target.served.redis()
    if client is None:
        return False
    with suppress(redis.RedisError, OSError):
        command(client)
        return True
    return False


def wipe_broker(target: Target) -> bool:
    """All messages are gone."""
    return _with_broker(target, lambda client: client.flushall())


def fill_broker(target: Target) -> bool:
    """Redis takes no more, for a while."""

    def room(size: int) -> bool:
        return _with_broker(target, lambda client: client.config_set("maxmemory", size))

    target.in_a_while(FULL, lambda: wait_for(lambda: room(0)))  # it may just be stalled, or dead
    return room(1)


def lose_message(target: Target) -> bool:
    """A message is taken, and nobody gets it."""
    lost: list[object] = []
    return _with_broker(target, lambda client: lost.append(client.rpop(QUEUE))) and lost != [None]


def double_messages(target: Target) -> bool:
    """Every message that lies there comes twice."""

    def double(client: redis.Redis) -> None:
        for message in client.lrange(QUEUE, 0, -1):
            client.lpush(QUEUE, message)

    return _with_broker(target, double)


def delay_message(target: Target) -> bool:
    """A message comes seconds late."""
    messages: list[Any] = []
    _with_broker(target, lambda client: messages.append(client.rpop(QUEUE)))
    if messages in ([], [None]):
        return False
    target.in_a_while(2.0, lambda: _with_broker(target, lambda client: client.lpush(QUEUE, *messages)))
    return True
