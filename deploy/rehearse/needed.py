"""What a rehearsal needs of the machine: root, and programs of packages of Debian."""

from __future__ import annotations

import os
import shutil

from chaos.postgres import binaries

PROGRAMS = {"buildah": "buildah", "debootstrap": "debootstrap", "redis-server": "redis-server", "ip": "iproute2",
            "nsenter": "util-linux"}  # fmt: skip
"""Packages by their programs."""

PATH = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])


def missing() -> list[str]:
    """What is not there, in words."""
    lacking = [package for program, package in PROGRAMS.items() if not shutil.which(program, path=PATH)]
    if binaries() is None:
        lacking.append("postgresql")
    told = ["root"] if os.geteuid() else []
    return told + ([f"apt-get install --no-install-recommends {' '.join(lacking)}"] if lacking else [])
