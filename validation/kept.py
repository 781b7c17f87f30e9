"""The rows of each scene as they were last measured, for what reads them: docs/measured.md is written from them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from validation.provenance import provenance
from validation.row import Row

FILE = Path(__file__).parent / "results" / "rows.json"


def keep(scene: str, rows: Sequence[Row]) -> None:
    """Put a scene's rows in the place of those of its last run."""
    scenes = json.loads(FILE.read_text(encoding="utf-8")) if FILE.is_file() else {}
    scenes[scene] = {"made with": provenance(), "rows": [asdict(row) for row in rows]}
    FILE.write_text(json.dumps(scenes, indent=1, default=np.generic.item) + "\n", encoding="utf-8")


def kept() -> dict[str, list[Row]]:
    """The rows by scene."""
    scenes = json.loads(FILE.read_text(encoding="utf-8"))
    return {scene: [Row(**row) for row in entry["rows"]] for scene, entry in scenes.items()}
