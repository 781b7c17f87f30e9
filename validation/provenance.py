"""What a printed table was made with: commit, CPU and versions."""

from __future__ import annotations

import platform
import subprocess
from importlib.metadata import version
from pathlib import Path


def provenance() -> list[str]:
    """Lines with the commit (marked if the tree differs from it), the CPU's model and the versions."""
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba"))
    return [f"commit {commit()}", f"CPU {cpu()}", f"Python {platform.python_version()}, {versions}"]


def commit() -> str:
    """The short name of the commit that is checked out."""
    folder = Path(__file__).parent.parent
    name, changed = (
        subprocess.run(["git", "-C", str(folder), *command], capture_output=True, text=True, check=False).stdout.strip()
        for command in (["rev-parse", "--short", "HEAD"], ["status", "--porcelain", "-uno", "solver"])
    )
    return (name or "unknown") + (" with changes in solver/" if changed else "")


def cpu() -> str:
    """The CPU's model, as the system tells it."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        models = [line for line in info.read_text(encoding="utf-8").splitlines() if line.startswith("model name")]
        if models:
            return models[0].split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
