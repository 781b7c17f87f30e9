"""What is wrong with a case: each fault as a JSON pointer, the value and the rule."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from service.meaning import IN_WORDS

_RULES = {
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
_NUMBERS = (
    (r"[-+]?\d+\.?\d*([eE][-+]?\d+)?", " without quotation marks"),
    (r"[-+]?\d+,\d+.*", " with a point, not a comma"),
    (r"[-+]?\d+\.?\d*([eE][-+]?\d+)?\s*[^\W\d].*", " alone, in SI units"),
)
"""Texts that were meant as numbers, and what is said of them."""
TAG = re.compile("<[a-z]+>")
"""What tells the kinds of a value apart; it is no field."""
MOST_ERRORS = 100
"""Faults of a case that are listed one by one."""
LONGEST_POINTER = 300
_LONGEST_VALUE = 60
_JSON = (bool, list, tuple, dict)
"""What Python writes in other words than JSON."""
_LARGEST_INTEGER = 10**15
"""Beyond it an integer is told by its size, not by its digits."""


@dataclass(frozen=True)
class FieldError:
    """One fault: where (RFC 6901 pointer, "" is the whole case), what stands there, what the rule is."""

    pointer: str
    value: Any
    rule: str

    @property
    def no_list(self) -> bool:
        """Whether there must be a list."""
        return self.rule.startswith(_RULES["tuple_type"])

    @property
    def unknown(self) -> bool:
        """Whether there is no field of this name."""
        return self.rule == _RULES["extra_forbidden"]

    def __str__(self) -> str:
        fault = f"{self.pointer or 'the case'} {self.rule}"
        if self.value is None:
            return fault
        told, colon, question = fault.rpartition(": ") if fault.endswith("?") else (fault, "", "")
        return f"{told}, got {short(self.value)}{colon}{question}"


class CaseError(ValueError):
    """A case that cannot be run: the first faults that were found, and how many `more` there are."""

    def __init__(self, errors: Sequence[FieldError], more: int = 0) -> None:
        self.errors, self.more = list(errors[:MOST_ERRORS]), more + max(len(errors) - MOST_ERRORS, 0)
        lines = [str(error) for error in self.errors]
        super().__init__("\n".join([*lines, f"and {self.more} more faults"] if self.more else lines))

    @classmethod
    def of(cls, error: ValidationError) -> CaseError:
        """The same faults as pydantic found them, in the words of this package."""
        details = [detail for detail in error.errors(include_url=False) if not _is_long_enough(detail)]
        return cls([field_error(detail) for detail in details[:MOST_ERRORS]], max(len(details) - MOST_ERRORS, 0))


def refusal(at: str, value: object, rule: str) -> PydanticCustomError:
    """The error that a model's validator raises about a field `at` (a relative pointer) within it."""
    return PydanticCustomError("refused", "refused", {"at": at, "value": value, "rule": rule})


def field_error(detail: ErrorDetails) -> FieldError:
    """A fault as pydantic found it, in the words of this package."""
    context = detail.get("ctx", {})
    parts = [str(part) for part in detail["loc"] if not TAG.fullmatch(str(part))]
    pointer = "".join("/" + part.replace("~", "~0").replace("/", "~1") for part in parts)
    if len(pointer) > LONGEST_POINTER:
        pointer = pointer[:LONGEST_POINTER] + "..."
    kind, value = detail["type"], detail["input"]
    if kind == "refused":
        at = context["at"]
        if "value" not in context and not isinstance(value, dict):  # of what tells the kinds of an object apart
            return FieldError(pointer, value, f"must be an object, whose {at} {context['rule']}")
        refused = context["value"] if "value" in context else value.get(at)
        return FieldError(pointer + (f"/{at}" if at else ""), plain(refused), context["rule"])
    if kind == "string_pattern_mismatch" and (words := IN_WORDS.get(context["pattern"])):
        return FieldError(pointer, value, words)
    if kind in _RULES:
        return FieldError(pointer, None if kind == "missing" else plain(value), _rule(detail))
    return FieldError(pointer, plain(value), detail["msg"].replace("Input should", "must"))


def _rule(detail: ErrorDetails) -> str:
    """The rule that a fault of a known kind breaks, and what else the value tells."""
    kind, value, place = detail["type"], detail["input"], detail["loc"]
    rule = _RULES[kind].format(**detail.get("ctx", {}))
    if kind == "missing":
        short_list = isinstance(value, (list, tuple)) and isinstance(place[-1], int)
        return rule + (f": the list ends after {len(value)} entries" if short_list else "")
    if value is None:
        return f"{rule}, not null"
    if isinstance(value, str) and kind in ("float_type", "int_type"):
        return rule + next((words for texts, words in _NUMBERS if re.fullmatch(texts, value.strip(), re.S)), "")
    if isinstance(value, list) and kind == "float_type" and place[-1] == "<number>":
        return f"{rule} or a table, which is an object"
    return rule


def _is_long_enough(detail: ErrorDetails) -> bool:
    """Whether a list is refused for too few entries only because some of them are refused."""
    return detail["type"] == "too_short" and len(detail["input"]) >= detail["ctx"]["min_length"]


def short(value: object) -> str:
    """A value as a message quotes it: large integers as 1e300, lists and objects as JSON, long texts by their start."""
    told = plain(value)
    text = repr(told)
    if isinstance(told, _JSON):
        text = json.dumps(told, ensure_ascii=not text.isprintable(), default=repr)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def plain(value: object) -> object:
    """The value, but an integer of many digits as a float, or as a text where there is no float so large."""
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) <= _LARGEST_INTEGER:
        return value
    try:
        return float(value)
    except OverflowError:
        return f"{Decimal(value):.0e}".replace("e+", "e")
