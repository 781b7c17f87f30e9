"""The client without await: the same text with other words."""

from __future__ import annotations

import re

HEAD = '''"""{subject} without await.

Written by `make client` from {source}: change that one.
"""
'''
WORDS = {
    r"\bawait ": "", r"\basync (def|with|for)\b": r"\1", r"\b__a(enter|exit)__\b": r"__\1__", r"\baclose\b": "close",
    r"\baread\b": "read", r"\baiter_": "iter_", r"\bAsyncIterator\b": "Iterator",
    r"\bAsync(Client|Job|Ensemble)\b": r"\1",
    r"\basyncio\.sleep\b": "time.sleep", r"^import asyncio\n": "",
    r"\basync_(ensembles|jobs)\b": r"\1", r"\bhockle_client\.asynchronous\b": "hockle_client.synchronous",
}  # fmt: skip


def without_await(source: str, text: str) -> str:
    """A module for programs without an event loop, from one for programs with one."""
    subject = text[3:].partition(", with await")[0]
    text = text[text.index('"""\n', 3) + 4 :]
    for pattern, replacement in WORDS.items():
        text = re.sub(pattern, replacement, text, flags=re.M)
    text = HEAD.format(source=source, subject=subject) + text
    text = text.replace("import Iterator, Iterable, Mapping", "import Iterable, Iterator, Mapping")
    return _realigned(_sorted(text))


def _sorted(text: str) -> str:
    """The imports of the client's own modules are in order again."""
    imports = re.findall(r"^from hockle_client\..*\n", text, flags=re.M)
    return text.replace("".join(imports), "".join(sorted(imports)), 1)


def _realigned(text: str) -> str:
    """Continued lines of a signature begin below its first argument again."""
    lines = text.split("\n")
    for i, line in enumerate(lines):
        opened = line.find("(") + 1
        if re.match(r" *def ", line) and line.count("(") > line.count(")"):
            for j in range(i + 1, len(lines)):
                lines[j] = " " * opened + lines[j].lstrip()
                if lines[j].rstrip().endswith(":"):
                    break
    return "\n".join(lines)
