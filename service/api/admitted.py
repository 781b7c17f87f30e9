"""Streams that last end with the key that opened them."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import suppress

from sqlalchemy.exc import SQLAlchemyError

from service.access import Caller, KeyStore

LOOK = 1.0
"""Seconds between two looks at a key, however many streams it has opened."""
log = logging.getLogger(__name__)


class Admitted:
    """Whether keys that were good still are."""

    def __init__(self, keys: KeyStore) -> None:
        self._keys = keys
        self._checks: dict[str, tuple[float, bool]] = {}
        """When each key was looked at (time.monotonic), and whether it was good."""

    async def while_good(self, caller: Caller, stream: AsyncGenerator[str, None]) -> AsyncIterator[str]:
        """The stream, until it ends or the caller's key is revoked or expires; without a key, all of it.

        It ends, too, where the database cannot be read: whoever follows comes back with the last event's id, and is
        told 503 until it can.
        """
        step: asyncio.Future[str | None] | None = None
        try:
            while await self._good(caller.key):
                step = step or asyncio.ensure_future(anext(stream, None))
                await asyncio.wait({step}, timeout=LOOK)
                if step.done():
                    event = step.result()
                    if event is None:
                        return
                    step = None
                    yield event
        except SQLAlchemyError as error:
            log.warning("a stream of events ends, as the database cannot be read: %s", error)
        finally:
            if step is not None:
                step.cancel()
                with suppress(asyncio.CancelledError, SQLAlchemyError):
                    await step
            await stream.aclose()

    async def _good(self, prefix: str) -> bool:
        if not prefix:
            return True
        checked, good = self._checks.get(prefix, (0.0, True))
        if time.monotonic() - checked < LOOK:
            return good
        with suppress(SQLAlchemyError):  # while the database is away nobody knows
            key = await asyncio.to_thread(self._keys.find, prefix)
            good = key is not None and key.is_good(time.time())
        self._checks = {key: check for key, check in self._checks.items() if time.monotonic() - check[0] < LOOK}
        self._checks[prefix] = time.monotonic(), good
        return good
