"""What a field of a case, a request or the settings means: said where it is defined, and nowhere else."""

from __future__ import annotations

from typing import Any

from pydantic import Field

NO_CONTROL = r"^[^\x00-\x1f\x7f]*$"
"""A text of one line; PostgreSQL, for one, takes no NUL."""

FILE_NAME = r"^[a-z0-9][a-z0-9-]*$"
"""What may name a file anywhere."""

IN_WORDS = {
    NO_CONTROL: "must be one line, without control characters",
    FILE_NAME: "must be small letters, digits and hyphens, and not begin with a hyphen",
}
"""What these patterns ask for."""


def means(text: str, unit: str = "") -> Any:
    """The meaning and the unit of a field, for its JSON schema; the guide's tables are written from that."""
    return Field(description=text, json_schema_extra={"unit": unit} if unit else None)
