"""Where a document's tables stand: between `<!-- table: NAME -->` and `<!-- end -->`."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

TABLE = re.compile(r"(?<=^<!-- table: )([a-z ]+)( -->\n).*?(?=^<!-- end -->$)", re.M | re.S)


def with_tables(text: str, tables: Mapping[str, Callable[[], str]]) -> str:
    """The text with each table written anew. Raises ValueError unless each is there, once and no other."""
    names = [match[1] for match in TABLE.finditer(text)]
    if sorted(names) != sorted(tables):
        raise ValueError(f"the document has the tables {sorted(names)}, and should have {sorted(tables)}")
    return TABLE.sub(lambda match: f"{match[1]}{match[2]}\n{tables[match[1]]()}\n", text)


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of cells; what would end a cell is escaped."""
    lines = [head, ["---"] * len(head), *([cell.replace("|", r"\|") for cell in row] for row in rows)]
    return "".join("|" + "|".join(f" {cell} " if cell else " " for cell in line) + "|\n" for line in lines)
