"""A child process that is started, looked after and stopped, with all that it started itself."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from service.pulse import Listener
from worker.parent import die_with_parent

PATIENCE = 10.0
REMEMBERED = 60.0
"""Seconds for which a death is remembered."""
LONGEST_PAUSE = 30.0


@dataclass
class Child:
    """A command that runs in a session of its own; its words go to `log`.

    `beat` gives what changes as long as the process with that id gets on.
    """

    name: str
    command: Sequence[str]
    log: Path
    beat: Callable[[int], object]
    environment: Mapping[str, str] = field(default_factory=dict)
    stop_signal: signal.Signals = signal.SIGTERM
    keep_fds: tuple[int, ...] = ()
    process: subprocess.Popen[bytes] | None = None
    _listener: Listener = field(default_factory=Listener)
    _deaths: deque[float] = field(default_factory=deque)
    _due: float | None = None
    """When it is to be started again (time.monotonic)."""

    def start(self) -> None:
        """Start it; it dies with this process, however that may end."""
        parent = os.getpid()
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, pass_fds=self.keep_fds,
                env={**os.environ, **self.environment}, start_new_session=True,
                preexec_fn=lambda: die_with_parent(parent),  # one prctl, no locks
            )
        self._listener = Listener()
        self._due = None

    def look_after(self) -> str:
        """End it if it stands still, and start it again if it has ended: at once, and after longer and longer pauses
        if it ends again and again. What happened, in words, or nothing."""
        if self._due is not None:
            if time.monotonic() >= self._due:
                self.start()
            return ""
        if self.ended:
            return f"died and {self._bury()}"
        if self.process is not None and self._listener.stands_still(self.beat(self.process.pid)):
            return f"stood still and {self._bury()}"
        return ""

    @property
    def ended(self) -> bool:
        """Whether it was started and has ended."""
        return self.process is not None and self.process.poll() is not None

    def ask_to_stop(self) -> None:
        """Send the signal at which it stops by itself."""
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(self.stop_signal)

    def make_stop(self) -> None:
        """Wait for its end, then kill what is left of it and of its own children."""
        if self.process is not None:
            with suppress(subprocess.TimeoutExpired):
                self.process.wait(PATIENCE)
            self._kill(self.process)
        self.process = None

    def _bury(self) -> str:
        """Kill what is left of it, and put it off to when it is started again."""
        if self.process is not None:
            self._kill(self.process)
        self.process = None
        now = time.monotonic()
        while self._deaths and now - self._deaths[0] > REMEMBERED:
            self._deaths.popleft()
        self._due = now + pause_after(len(self._deaths))
        self._deaths.append(now)
        return "is started again" + (f" in {self._due - now:.0f} s" if self._due > now else "")

    @staticmethod
    def _kill(process: subprocess.Popen[bytes]) -> None:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def pause_after(deaths: int) -> float:
    """Seconds to wait before another start after so many deaths within REMEMBERED."""
    return min(2.0 ** (deaths - 1), LONGEST_PAUSE) if deaths else 0.0
