"""`python -m docs`: write the tables of the guide from the code, and those of measured.md from the kept results."""

from __future__ import annotations

from pathlib import Path

from docs import guide, measured
from docs.markers import with_tables

HERE = Path(__file__).parent
DOCUMENTS = {"guide.md": guide.TABLES, "measured.md": measured.TABLES}
"""The tables of each document, by their names in its markers."""


def written(document: str) -> str:
    """The text of a document with its tables as they should be now."""
    return with_tables((HERE / document).read_text(encoding="utf-8"), DOCUMENTS[document])


if __name__ == "__main__":
    for document in DOCUMENTS:
        (HERE / document).write_text(written(document), encoding="utf-8")
