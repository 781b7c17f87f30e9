"""A text that is not JSON: the place, its line with a mark, and what was likely meant."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from service.cases import CaseError, load_case
from service.cases.slips import Slip

GOOD = """{
  "rod": {
    "length": 1.5,
    "diameter": 0.01
  },
  "initial": {"shape": "straight", "direction": [0, 0, 1]},
  "t_end": 2.0
}
"""

SLIPS = [
    # what stands in GOOD, what stands there instead, line and column of the slip, what is said
    ("1.5,", "1,5,", (3, 17), "a decimal point, not a comma"),
    ("0.01", "0.01,", (4, 21), "a comma stands after the last value of an object"),
    ("1]", "1,]", (6, 57), "a comma stands after the last entry of a list"),
    ("1.5,", "1.5, // m", (3, 20), "no comments"),
    ("1.5,", "1.5, /* m */", (3, 20), "no comments"),
    ("1.5,", "1.5 # m\n,", (3, 19), "no comments"),
    ('"length"', "'length'", (3, 5), "double quotes"),
    ('"length"', "“length”", (3, 5), "printed text"),
    ('"length"', "length", (3, 5), 'write "length"'),
    ('"straight"', "straight", (6, 24), 'write "straight"'),
    ('"straight"', "True", (6, 24), "true, false and null"),
    ('"straight"', "None", (6, 24), "true, false and null"),
    ("1.5", "nan", (3, 15), "must be finite"),
    ("1.5,", "1.5", (3, 18), "a comma is missing after this value"),
    ("1.5,", "1.5;", (3, 18), "not a semicolon"),
    ("1.5,", "1.5,,", (3, 19), "two commas"),
    ("1.5", "", (3, 15), "a value is missing after the colon"),
    ("1.5", ".5", (3, 15), "a digit stands before the point"),
    ("1.5", "1.", (3, 16), "a number is written as"),
    ("1.5", "01", (3, 16), "a number is written as"),
    ("1.5", "+1", (3, 15), "no + before it"),
    ("1.5", "1.5 m", (3, 18), "take 'm' away"),
    ("1.5", "3/2", (3, 16), "does not calculate"),
    ("1.5", "pi", (3, 15), "does not calculate"),
    ("[0, 0, 1]", "0, 0, 1", (6, 52), "in brackets"),
    ("[0, 0, 1]", "(0, 0, 1)", (6, 49), "in brackets"),
    ("[0, 0, 1]", "[0, 0, 1", (6, 57), "the [ of line 6 is not closed before this }"),
    ('{"shape"', '["shape"', (6, 22), "this is a list"),
    ('"length":', '"length" =', (3, 14), "a colon is missing"),
    ('"length"', '"length', (3, 18), "no closing double quote"),
    (GOOD, '{"rod', (1, 2), "the text that begins here has no closing double quote"),
    (GOOD, '{"rod\n', (1, 6), "the text that begins in this line has no closing double quote"),
    ("straight", "C:\\data", (6, 27), "a backslash in a text is written twice"),
    ("  },", "  }},", (5, 5), "a } before it is one too many"),
    ("2.0\n}", "2.0\n}}", (8, 2), "this } closes nothing"),
    ("2.0\n}", "2.0", (7, 15), "the { of line 1 is not closed"),
    ("  },\n", "  ,\n", (8, 2), "the { of line 2 is not closed"),
    (GOOD, "", (1, 1), "the text is empty"),
    (GOOD, "length: 1", (1, 1), "an object, which begins with {"),
]


def slip_of(text: str) -> Slip:
    with pytest.raises(json.JSONDecodeError) as refused:
        json.loads(text)
    return Slip.of(refused.value)


@pytest.mark.parametrize(("good", "bad", "place", "told"), SLIPS, ids=[repr(bad)[:30] for _, bad, *_ in SLIPS])
def test_a_slip_is_told_by_its_place_and_in_words(good: str, bad: str, place: tuple[int, int], told: str):
    assert good in GOOD
    slip = slip_of(GOOD.replace(good, bad, 1))
    assert ((slip.line, slip.column), told in slip.meant) == (place, True), slip


def test_the_line_is_shown_with_a_mark_below_the_place(tmp_path: Path):
    path = tmp_path / "mine.json"
    path.write_text(GOOD.replace("1.5,", "1,5,"))
    with pytest.raises(CaseError) as refused:
        load_case(path)
    told, line, mark = str(refused.value).split("\n")
    assert told.startswith(f"the case is not JSON in {path}, line 3, column 17: a number has a decimal point")
    assert (line, mark) == ('      "length": 1,5,', "                  ^")


@pytest.mark.parametrize("before", [0, 5, 40, 4000])
def test_of_a_long_line_a_part_is_shown(before: int):
    slip = slip_of("[" + "1," * before + " 0.5m" + ", 1" * 4000 + "]")
    assert len(slip.text) <= 72
    assert slip.text[: len(slip.mark) - 1].endswith("0.5")


@pytest.mark.parametrize("text", ['{"a": "' + '\\"' * 300_000, "[" * 900 + ",", '{"a": [' + "[1]," * 200_000 + "}",
                                  "1, " * 300_000])  # fmt: skip
def test_a_text_of_a_megabyte_is_told_of_at_once(text: str):
    assert slip_of(text).meant
