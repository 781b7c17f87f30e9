"""The rows that are kept are those that are read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from validation import kept
from validation.row import Row


def test_rows_of_numpy_numbers_are_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(kept, "FILE", tmp_path / "rows.json")
    kept.keep("scene", [Row("what", np.int64(3), np.float64(2.5), np.float64(0.5), 1.0)])  # type: ignore[arg-type]
    assert kept.kept() == {"scene": [Row("what", 3, 2.5, 0.5, 1.0)]}
