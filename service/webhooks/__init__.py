"""Tells who asked for it, at an address of theirs, that a job has ended."""

from service.webhooks.notifier import Notifier

__all__ = ["Notifier"]
