"""Texts of any kind to whatever reads what strangers send: each says yes, or no in the way it promises."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from chaos.attack.table import Row
from service.access import authenticate
from service.access.caller import Refused
from service.api.bodies import parse
from service.api.datasets import DatasetFile
from service.api.gate import _name_in
from service.api.preferences import wait_preferred
from service.api.problems import Problem
from service.cases import CaseError, apply_settings, load_case, parse_case, shipped_cases
from service.settings import from_environment, variable
from service.webhooks import fault_of

AT_ONCE = 200
NICE = 10
TEXT = st.text(max_size=300)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=30),
    lambda below: st.lists(below, max_size=4) | st.dictionaries(st.text(max_size=12), below, max_size=4), max_leaves=20,
)  # fmt: skip
CASES = [load_case(name) for name in shipped_cases()]
KEYS = sorted({key for case in CASES for key in case})
SETTINGS = [variable(name) for name in ("lease", "quota", "database", "broker", "objects", "hosts", "keep_days")]


def _case(part: Any) -> object:
    key, value, base = part
    return parse_case(apply_settings(base, {key: value}))


def _setting(part: tuple[str, str]) -> object:
    return from_environment({part[0]: part[1]})


PARSERS: dict[str, tuple[Callable[[Any], object], Any, tuple[type[Exception], ...]]] = {
    "body of a request": (parse, st.binary(max_size=400) | JSON.map(lambda value: repr(value).encode()), (Problem,)),
    "case": (parse_case, JSON, (CaseError,)),
    "field of a case": (_case, st.tuples(st.sampled_from(KEYS) | TEXT, JSON, st.sampled_from(CASES)), (CaseError,)),
    "Authorization header": (lambda header: authenticate(header, lambda _: None, True, 0.0), TEXT | st.none(),
                             (Refused,)),
    "Range header": (lambda header: DatasetFile._parse_range_header(header, 1000), TEXT | TEXT.map("bytes={}".format),
                     (Problem,)),
    "Prefer header": (wait_preferred, TEXT | TEXT.map("wait={}".format), ()),
    "Host header": (lambda header: _name_in(f"//{header}"), TEXT, ()),
    "address of a webhook": (fault_of, TEXT | TEXT.map("http://{}/".format), ()),
    "setting": (_setting, st.tuples(st.sampled_from(SETTINGS), TEXT), (ValueError,)),
}  # fmt: skip
"""The parser, its texts, and the exceptions by which it refuses them."""


def parsers(first_seed: int, seconds: float, minutes: float) -> list[Row]:
    """Try each for so many seconds of CPU time, in so many minutes in all; the seeds go on from the first."""
    within = 60.0 * minutes / len(PARSERS)
    return [_row(name, first_seed, seconds, within) for name in PARSERS]


def patient_parsers(first_seed: int, seconds: float, minutes: float) -> list[Row]:
    """The same in a process of its own, which leaves the CPU to whoever else wants it."""
    os.nice(NICE)
    return parsers(first_seed, seconds, minutes)


def _row(name: str, first_seed: int, seconds: float, within: float) -> Row:
    read, strategy, refusals = PARSERS[name]
    began, number, tried, fault = time.process_time(), first_seed, 0, ""
    end = time.monotonic() + within

    def try_text(text: Any) -> None:
        nonlocal tried
        tried += 1
        with suppress(*refusals):
            read(text)

    bounds = settings(max_examples=AT_ONCE, deadline=None, database=None, phases=[Phase.generate, Phase.shrink],
                      suppress_health_check=list(HealthCheck))  # fmt: skip
    while not fault and time.process_time() - began < seconds and time.monotonic() < end:
        try:
            seed(number)(bounds(given(strategy)(try_text)))()  # type: ignore[no-untyped-call]
        except Exception as error:  # whatever it is, it was not promised
            fault = f"seed {number}: {type(error).__name__}: {str(error)[:200]}".replace("\n", " ").replace("|", "/")
        number += 1
    text = f"{tried:,} texts, seeds {first_seed} to {number - 1}, {time.process_time() - began:.0f} s of CPU"
    return Row(f"parser: {name}", fault or text, "yes, or the no that is promised", not fault)
