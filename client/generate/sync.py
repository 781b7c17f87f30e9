"""The client without await: the same text with other words."""

from __future__ import annotations

import re

HEAD = '''"""The service as a Python program sees it.

Written by `make client` from asynchronous.py: change that one.
"""
'''
WORDS = {
    r"\bawait ": "", r"\basync (def|with|for)\b": r"\1", r"\b__a(enter|exit)__\b": r"__\1__", r"\baclose\b": "close",
    r"\baread\b": "read", r"\baiter_": "iter_", r"\bAsyncIterator\b": "Iterator", r"\bAsync(Client|Job)\b": r"\1",
    r"\basyncio\.sleep\b": "time.sleep", r"^import asyncio\n": "",
}  # fmt: skip


def without_await(text: str) -> str:
    """A module for programs without an event loop, from one for programs with one."""
    text = HEAD + text[text.index('"""\n', 3) + 4 :]
    for word, other in WORDS.items():
        text = re.sub(word, other, text, flags=re.M)
    text = text.replace("import Iterator, Iterable, Mapping", "import Iterable, Iterator, Mapping")
    return _realigned(text)


def _realigned(text: str) -> str:
    """Continued lines of a signature begin below its first argument again."""
    lines = text.split("\n")
    for i, line in enumerate(lines):
        opened = line.rfind("(") + 1
        if re.match(r" *def ", line) and line.count("(") > line.count(")"):
            for j in range(i + 1, len(lines)):
                lines[j] = " " * opened + lines[j].lstrip()
                if lines[j].rstrip().endswith(":"):
                    break
    return "\n".join(lines)
