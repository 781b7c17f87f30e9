"""The rules that values of a case break, in words."""

from __future__ import annotations

import re

from pydantic_core import ErrorDetails

RULES = {
    "missing": "is required",
    "extra_forbidden": "is not a known field",
    "finite_number": "must be a finite number",
    "greater_than": "must be > {gt:g}",
    "greater_than_equal": "must be >= {ge:g}",
    "less_than": "must be < {lt:g}",
    "less_than_equal": "must be <= {le:g}",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_from_float": "must be an integer",
    "int_type": "must be an integer",
    "int_parsing": "must be an integer",
    "string_type": "must be a text",
    "bool_type": "must be true or false",
    "string_pattern_mismatch": "must match {pattern}",
    "string_too_short": "must have at least {min_length} characters",
    "string_too_long": "must have at most {max_length} characters",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
    "tuple_type": "must be a list",
    "model_type": "must be an object",
    "literal_error": "must be {expected}",
    "enum": "must be {expected}",
    "value_error": "{error}",
}
"""What a value must be, by pydantic's name of the fault."""
NUMBERS = (
    (r"[-+]?\d+\.?\d*([eE][-+]?\d+)?", " without quotation marks"),
    (r"[-+]?\d+,\d+.*", " with a point, not a comma"),
    (r".*\b(sin|cos|exp|sqrt|tanh)\s*\(.*",
     ", not a formula: a function of time is a table, of some 20 points a period with interpolation cubic"),
    (r"[-+]?\d+\.?\d*([eE][-+]?\d+)?\s*[^\W\d].*", " alone, in SI units"),
)
"""Texts that were meant as numbers, and what is said of them."""
LONGEST_NUMBER = 60
"""Letters of a text that is looked at so."""
KINDS = ("float_type", "model_type", "tuple_type", "literal_error")
"""Faults of a value that is of another kind than it must be."""
ALSO = {"<number>": " or a table, which is an object", "<end>": " or the name of a preset",
         "<three>": " or 'initial'", "<word>": " or a list of 3 entries"}  # fmt: skip
"""What such a value may be besides, by the tag of the kind that it was taken for."""
REQUIRED: dict[object, str] = {
    "interpolation": ": linear, smoothstep, pchip or cubic; smoothstep begins and ends at rest",
}
"""What is said of a field that is missing, by its name."""
STAYS: dict[object, str] = {
    ("loads", "gravity"): "; gravity stays the same: a load that changes is in loads.distributed, with a schedule",
}
"""What is said where a number is given as a function, by the place."""


def rule_of(detail: ErrorDetails) -> str:
    """The rule that a fault of `RULES` breaks, in words, and what the value tells besides."""
    kind, value, place = detail["type"], detail["input"], detail["loc"]
    rule = RULES[kind].format(**detail.get("ctx", {}))
    if kind == "missing":
        short_list = isinstance(value, (list, tuple)) and isinstance(place[-1], int)
        return rule + (f": the list ends after {len(value)} entries" if short_list else REQUIRED.get(place[-1], ""))
    if isinstance(value, dict) and place[:2] in STAYS:
        return rule + STAYS[place[:2]]
    if kind in ("float_type", "int_type") and isinstance(value, str) and len(value) <= LONGEST_NUMBER:
        meant = next((words for text, words in NUMBERS if re.fullmatch(text, value.strip())), "")
        if meant:
            return rule + meant
    rule += ALSO.get(str(place[-1]), "") if place and kind in KINDS else ""
    return f"{rule}, not null" if value is None else rule
