"""Tells who asked for it, at an address of theirs, that a job has ended."""

from service.webhooks.notifier import Notifier
from service.webhooks.public import fault_of

__all__ = ["Notifier", "fault_of"]
