"""A child process that is started, looked after and stopped, with all that it started itself."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from worker.parent import die_with_parent

PATIENCE = 10.0


@dataclass
class Child:
    """A command that runs in a session of its own; its words go to `log`."""

    name: str
    command: Sequence[str]
    log: Path
    environment: Mapping[str, str] = field(default_factory=dict)
    stop_signal: signal.Signals = signal.SIGTERM
    keep_fds: tuple[int, ...] = ()
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it; it dies with this process, however that may end."""
        parent = os.getpid()
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, pass_fds=self.keep_fds,
                env={**os.environ, **self.environment}, start_new_session=True,
                preexec_fn=lambda: die_with_parent(parent),  # one prctl, no locks
            )

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
        if self.process is None:
            return
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(PATIENCE)
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.process = None
