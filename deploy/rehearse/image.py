"""The image, built by buildah on a base that debootstrap makes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
BASE, IMAGE = "localhost/hockle-base", "localhost/hockle"
SUITE = "bookworm"
COMMIT = "org.opencontainers.image.revision"
"""The label that says of what an image was built."""
THIS_MACHINE = ("/etc/pip.conf", "/etc/ssl/certs/ca-certificates.crt")
"""How this machine reaches the package index: copied into the base, and never into the repository."""


@dataclass(frozen=True)
class Image:
    """A built image: where its files are, and what it says of itself."""

    files: Path
    user: str
    environment: dict[str, str]
    entrypoint: list[str]
    directory: str
    commit: str


class Builder:
    """buildah without an engine: plain copies as layers, chroot as isolation. What it keeps lies in `folder`."""

    def __init__(self, folder: Path, log: Path) -> None:
        self._folder, self._log, self._laid_out = folder, log, ""
        folder.mkdir(parents=True, exist_ok=True)
        configuration = folder / "storage.conf"
        configuration.write_text(f'[storage]\ndriver = "vfs"\nrunroot = "{folder}/run"\ngraphroot = "{folder}/graph"\n')
        temporary = folder / "tmp"
        temporary.mkdir(exist_ok=True)
        self._environment = os.environ | {"CONTAINERS_STORAGE_CONF": str(configuration), "TMPDIR": str(temporary),
                                          "BUILDAH_ISOLATION": "chroot"}  # fmt: skip

    def base(self) -> None:
        """Make the base, once: a small Debian with Python."""
        if self._has(BASE):
            return
        tree = self._folder / "base"
        if not (tree / "usr/bin/python3").exists():
            self._run("debootstrap", "--variant=minbase", "--include=python3,python3-venv,python3-pip,ca-certificates",
                      SUITE, str(tree))  # fmt: skip
        for path in filter(os.path.exists, THIS_MACHINE):
            shutil.copy(path, tree / path[1:])
        container = self._buildah("from", "scratch")
        self._buildah("copy", container, str(tree), "/")
        self._buildah("commit", container, BASE)
        self._buildah("rm", container)

    def build(self) -> None:
        """Build the image from deploy/Dockerfile."""
        commit = subprocess.check_output(["git", "describe", "--always", "--dirty"], cwd=ROOT, text=True).strip()
        self._run("buildah", "build", "--format", "docker", "--build-arg", f"BASE={BASE}",
                  "--label", f"{COMMIT}={commit}", "--file", "deploy/Dockerfile", "--tag", IMAGE, ".")  # fmt: skip

    def image(self) -> Image:
        """The built image, with its files laid out."""
        told: dict[str, Any] = json.loads(self._buildah("inspect", "--type", "image", IMAGE))["Docker"]["config"]
        self._laid_out = self._buildah("from", "--pull-never", IMAGE)
        files = Path(self._buildah("mount", self._laid_out))
        environment = dict(line.split("=", 1) for line in told["Env"])
        return Image(files, told["User"], environment, told["Entrypoint"], told["WorkingDir"],
                     (told["Labels"] or {}).get(COMMIT, "unknown"))  # fmt: skip

    def close(self) -> None:
        """Take the laid out files away; the images stay, for the next time."""
        if self._laid_out:
            self._buildah("rm", self._laid_out)

    def _has(self, name: str) -> bool:
        return subprocess.run(["buildah", "inspect", "--type", "image", name], env=self._environment,
                              capture_output=True).returncode == 0  # fmt: skip

    def _buildah(self, *words: str) -> str:
        told = subprocess.check_output(["buildah", *words], env=self._environment, text=True)
        return told.strip()

    def _run(self, *command: str) -> None:
        with self._log.open("ab") as log:
            subprocess.run(command, cwd=ROOT, env=self._environment, stdout=log, stderr=log, check=True)
