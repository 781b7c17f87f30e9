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

from service.cases.rules import RULES, rule_of
from service.meaning import IN_WORDS

TAG = re.compile("<[a-z]+>")
"""What tells the kinds of a value apart; it is no field."""
MOST_ERRORS = 100
"""Faults of a case that are listed one by one."""
LONGEST_POINTER = 300
_LONGEST_VALUE = 60
_DIGITS = 15
"""A float has so many decimal digits, and no more."""
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
        return self.rule.startswith(RULES["tuple_type"])

    @property
    def unknown(self) -> bool:
        """Whether there is no field of this name."""
        return self.rule == RULES["extra_forbidden"]

    @property
    def missing(self) -> bool:
        """Whether a field that must be there is not."""
        return self.rule.startswith(RULES["missing"])

    def __str__(self) -> str:
        fault = f"{self.pointer or 'the case'} {self.rule}"
        if self.value is None:
            return fault
        hint = self._hint
        return f"{fault.removesuffix(hint)}, got {short(self.value)}{hint}"

    @property
    def _hint(self) -> str:
        """What the rule says beyond the rule: what was meant, or what there is instead."""
        if self.rule.startswith(RULES["extra_forbidden"]):
            return "".join(self.rule.partition(": ")[1:])
        return "".join(self.rule.rpartition(": ")[1:]) if self.rule.endswith("?") else ""


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
    location = tuple(map(str, detail["loc"]))
    named = location[-1:] if detail["type"] == "extra_forbidden" else ()  # by who sent it, however it looks
    parts = [part for part in location[: len(location) - len(named)] if not TAG.fullmatch(part)] + list(named)
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
    if kind in RULES:
        return FieldError(pointer, None if kind == "missing" else plain(value), rule_of(detail))
    return FieldError(pointer, plain(value), detail["msg"].replace("Input should", "must"))


def _is_long_enough(detail: ErrorDetails) -> bool:
    """Whether a list is refused for too few entries only because some of them are refused."""
    return detail["type"] == "too_short" and len(detail["input"]) >= detail["ctx"]["min_length"]


def short(value: object) -> str:
    """A value as a message quotes it: large integers as 1e300, lists and objects as JSON, long texts by their start."""
    told = plain(value)
    text = repr(told)
    if isinstance(told, float) and len(text) > _DIGITS:  # 40.00000000000001
        text = f"{told:.{_DIGITS}g}"
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
