"""How the workers are told that there is a job. It may fail: the reconciler rings again."""

from __future__ import annotations

import logging
from typing import Any

from celery import Celery
from kombu.exceptions import OperationalError
from redis.exceptions import RedisError

from service.settings import Settings

TASK = "hockle.run_next"
QUEUE = "hockle"
BROKEN = (OperationalError, OSError, RedisError)  # the last where Redis answers, but has no room
ONCE_MORE = {"max_retries": 1, "interval_start": 0}  # a connection may have gone stale
log = logging.getLogger(__name__)


def celery_settings(settings: Settings) -> dict[str, Any]:
    """Celery's settings, the same for who rings and who answers."""
    common: dict[str, Any] = {
        "task_ignore_result": True,
        "task_serializer": "json",
        "accept_content": ["json"],
        "task_acks_late": False,  # the registry, not the broker, knows which job is lost
        "worker_prefetch_multiplier": 1,
        "task_default_queue": QUEUE,
        "broker_connection_retry_on_startup": True,
        "broker_connection_max_retries": None,
        "worker_cancel_long_running_tasks_on_connection_loss": False,
    }
    if not settings.broker:
        folder = str(settings.messages.absolute())
        return common | {
            "broker_url": "filesystem://localhost",
            "broker_transport_options": {"data_folder_in": folder, "data_folder_out": folder,
                                         "control_folder": folder},
            "worker_enable_remote_control": False,
        }
    return common | {
        "broker_url": settings.broker,
        "worker_disable_prefetch": True,
        "broker_transport_options": {"socket_timeout": 5.0, "socket_connect_timeout": 5.0,
                                     "visibility_timeout": 10 * 365 * 86400},
    }


class Doorbell:
    """Rings the workers."""

    def __init__(self, settings: Settings) -> None:
        self._celery = Celery("hockle", set_as_current=False)
        self._celery.conf.update(celery_settings(settings))
        self._celery.conf.broker_transport_options |= ONCE_MORE

    def ring(self) -> bool:
        """Have one worker look for a job; False if the broker could not be reached."""
        try:
            self._celery.send_task(TASK, retry_policy=ONCE_MORE)
        except BROKEN as error:
            log.warning("the broker took no message, it will be told again: %s", error)
            return False
        return True

    def leave(self, messages: int) -> None:
        """Ring until so many `messages` lie unanswered, or the broker cannot be reached."""
        try:
            with self._celery.connection_or_acquire() as connection:  # one that is kept: a new one takes 1.5 ms
                connection.ensure_connection(**ONCE_MORE)
                unanswered = connection.default_channel.queue_declare(QUEUE, passive=False).message_count
        except BROKEN as error:
            log.warning("the broker cannot be reached, it will be told again: %s", error)
            return
        for _ in range(messages - unanswered):
            if not self.ring():
                return

    def reachable(self) -> bool:
        """Whether the broker answers."""
        try:
            with self._celery.connection_for_write() as connection:
                connection.ensure_connection(**ONCE_MORE)
                connection.default_channel  # noqa: B018  # opening it asks the broker
        except BROKEN:
            return False
        return True

    def close(self) -> None:
        """Close the connections to the broker."""
        self._celery.close()
