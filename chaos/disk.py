"""A disk that is soon full: a small file system in memory, where this process may mount one."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SIZE = "600m"


@contextmanager
def small_disk(directory: Path, size: str = SIZE) -> Iterator[bool]:
    """Mount one at `directory`, which is made, while the block runs; yields whether that could be done."""
    directory.mkdir(parents=True, exist_ok=True)
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size},mode=700", "hockle-chaos", str(directory)],
                             capture_output=True, check=False).returncode == 0  # fmt: skip
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "--lazy", str(directory)], check=True)


def fill(ballast: Path) -> None:
    """Give all that is free on a disk to a new file."""
    with ballast.open("wb") as file:
        size = block = 1 << 27
        while block >= 1 << 12:
            try:
                os.posix_fallocate(file.fileno(), 0, size)
                size += block
            except OSError:
                block >>= 1
                size -= block
