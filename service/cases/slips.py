"""What a text that is not JSON was likely meant to say: the place, its line, and words for common slips."""

from __future__ import annotations

import re
from dataclasses import dataclass
from json import JSONDecodeError

VALUE, NAME, COMMA, COLON = "Expecting value", "Expecting property name", "Expecting ',' delimiter", "Expecting ':'"
NUMBER = "a number is written as 15, -0.5 or 1.5e9"
OPEN = "the {open} of line {line} is not closed"
SLIPS = (
    ("Invalid control", "", r"[\r\n]", "the text that begins in this line has no closing double quote"),
    ("Invalid control", "", "", r"a control character in a text must be written as \t or \u0009, say"),
    ("Unterminated", "", "", "the text that begins here has no closing double quote"),
    (r"Invalid \\", "", "", r"a backslash in a text is written twice: \\"),
    ("", "", r"//|/\*|#", "JSON has no comments: take it away, or put it into `description`"),
    ("", "", "[“”„‟«»″]", 'this is the quotation mark of a printed text: write "'),
    ("", "", "['‘’`]", 'names and texts stand in double quotes: write "'),
    ("", "", r",\s*\}", "a comma stands after the last value of an object: take it away"),
    ("", "", r",\s*\]", "a comma stands after the last entry of a list: take it away"),
    ("Unexpected UTF-8 BOM", "", "", "the text begins with a byte order mark: leave it out"),
    ("Extra data", "", r"[\]}]", "this {at} closes nothing: take it away, or look for one before it that is too early"),
    ("Extra data", "", ",", "the case has ended before this comma: a }} before it is one too many"),
    ("Extra data", "", "", "something stands after the end: take it away"),
    (VALUE, r"\A\s*\Z", r"\s*\Z", "the text is empty: it must be an object, which begins with {{"),
    (VALUE, r"\A\s*\Z", "", "it must be an object, which begins with {{"),
    (f"{VALUE}|{NAME}", r",\s*\Z", ",", "two commas stand here: take one away"),
    ("", "", r"\s*\Z", OPEN),
    (NAME, r"\d,\Z", r"\d", "a number has a decimal point, not a comma: write 1.5, not 1,5"),
    (NAME, r"[\d.],\s+\Z", r"[-+.\d]", "several numbers are a list, in brackets: [0, 0, 1]"),
    (NAME, "", r"\w", 'a name stands in double quotes: write "{word}"'),
    (NAME, "", "", "a name in double quotes must stand here"),
    (COMMA, "", r"[\]}]", f"{OPEN} before this {{at}}"),
    (COMMA, r"\d\s*\Z", r"\s*[-+*/^]", "JSON does not calculate: write the number that comes out"),
    (COMMA, r"\d\Z", r"\s*(?![eExX_])[^\W\d]|\s*[°%]", "numbers are in SI units, without a unit: take {word!r} away"),
    (COMMA, r"\d\Z", r"[.\w]", NUMBER),
    (COMMA, "", r"\s*;", "a comma must stand here, not a semicolon"),
    (COMMA, "", r"\s*:", "a name and its value stand in an object, between {{ and }}: this is a list"),
    (COMMA, "", "", "a comma is missing after this value"),
    (COLON, "", "", "a colon is missing here, between a name and its value"),
    (VALUE, r":\s*\Z", r"[,}\]]", "a value is missing after the colon"),
    (VALUE, "", r"(?i:true|false|none|null|undefined)\b", "JSON writes true, false and null, in small letters"),
    (VALUE, "", r"[-+]?(?i:nan|inf)", "a number must be finite: write one, or leave the field out"),
    (VALUE, "", r"[-+]?(\w+\.)?(pi|sqrt|sin|cos)\b", "JSON does not calculate: write the number that comes out"),
    (VALUE, "", r"\+", "a number has no + before it"),
    (VALUE, "", "-?[.]", f"a digit stands before the point: {NUMBER}"),
    (VALUE, "", r"\(", "a list stands in brackets: [0, 0, 1]"),
    (VALUE, "", r"[^\W\d]", 'a text stands in double quotes: write "{word}"'),
    (VALUE, "", "", "a number, a text in double quotes, a list or an object must stand here"),
)  # fmt: skip
"""What Python says, what stands before the place, what stands there, and what that means: the first row that fits."""
NEAR = 1000
"""Letters around the place that are looked at."""
SHOWN = 72
"""Letters of its line that are shown."""
BRACKETS = re.compile(r'"(?:\\.|[^"\\])*"?|[\[\]{}]', re.S)
INDENTED = 100
"""Letters by which a line may be indented so that it is seen."""


@dataclass(frozen=True)
class Slip:
    """What is wrong with a text: the line and column, from 1 on, the line around there, with a mark below, and what
    was likely meant."""

    line: int
    column: int
    text: str
    mark: str
    meant: str

    @classmethod
    def of(cls, error: JSONDecodeError) -> Slip:
        """What Python's reader of JSON stumbled over."""
        text, at = error.doc, _place(error)
        begin, end = text.rfind("\n", 0, at) + 1, text.find("\n", at)
        end = len(text) if end < 0 else end
        first = max(begin, min(at - SHOWN // 2, end - SHOWN))
        seen = "".join(letter if letter.isprintable() else " " for letter in text[first : min(end, first + SHOWN)])
        mark = " " * (at - first) + "^"
        return cls(text.count("\n", 0, at) + 1, at - begin + 1, seen.rstrip(), mark, _meant(error.msg, text, at))

    def __str__(self) -> str:
        return f"line {self.line}, column {self.column}: {self.meant}"


def _place(error: JSONDecodeError) -> int:
    """Where the slip is: at a comma that is one too many, behind the value that a comma is missing after, or where the
    text ends; else where Python's reader stopped."""
    text, at = error.doc, error.pos
    before, there = len(text[:at].rstrip()), text[at : at + 1]
    if there in ("}", "]") and text[before - 1 : before] == ",":
        return before - 1
    ends_here = not there or (error.msg.startswith((VALUE, NAME)) and not text[at:].strip())
    return before if ends_here or (error.msg.startswith(COMMA) and there not in "]}/#") else at


def _meant(said: str, text: str, at: int) -> str:
    before, after = text[max(at - NEAR, 0) : at], text[at : at + NEAR]
    words = next((words for python, behind, there, words in SLIPS if re.match(python, said)
                  and re.search(behind, before) and re.match(there, after)), said)  # fmt: skip
    opened = _unclosed(text[:at]) if "{open}" in words else 0
    word = re.search(r"[\w°%]+", after)
    return words.format(open=text[opened : opened + 1], line=text.count("\n", 0, opened) + 1, at=after[:1],
                        word=word[0][:SHOWN] if word else "")  # fmt: skip


def _unclosed(text: str) -> int:
    """Where the bracket is that was likely left open: the first one whose line is indented farther than the line that
    begins with what closes it; else the last one that nothing closes."""
    opened: list[int] = []
    for bracket in BRACKETS.finditer(text):
        if bracket[0] in ("{", "["):
            opened.append(bracket.start())
        elif bracket[0] in ("}", "]") and opened:
            last, closing = opened.pop(), _line_before(text, bracket.start())
            if closing.isspace() or not closing:
                own = _line_before(text, last)
                if len(own) - len(own.lstrip()) > len(closing):
                    return last
    return opened[-1] if opened else 0


def _line_before(text: str, at: int) -> str:
    """What stands in the line before a place."""
    return text[max(at - INDENTED, 0) : at].rpartition("\n")[2]
