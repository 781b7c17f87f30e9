"""Types of cases for editors and type checkers, from the JSON schema of a case."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from typing import Any

HEAD = '''"""What a case may hold. It is plain data: these types tell editors and type checkers what goes where.

Written by `make client` from the service's schema of cases: change that one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Union

from typing_extensions import NotRequired, TypedDict
'''
PLAIN = {"string": "str", "number": "float", "integer": "int", "boolean": "bool", "null": "None"}
WIDTH = 112


def types_of(schema: dict[str, Any]) -> str:
    """The module that declares each object of the schema, and the dotted keys of what can be set."""
    parts: dict[str, dict[str, Any]] = {**schema["$defs"], schema["title"]: schema}
    keys = sorted(set(_keys(schema, parts)))
    setting = "Setting = Literal[\n" + "".join(f'    "{key}",\n' for key in keys) + "]\n"
    docstring = '"""The dotted keys of a case without those that count entries, as loads.point.0.s."""\n'
    return HEAD + "".join(_declaration(name, part) for name, part in parts.items()) + "\n\n" + setting + docstring


def _declaration(name: str, part: dict[str, Any]) -> str:
    lines = [f"\n\nclass {name}(TypedDict):\n", _documented(part["description"])]
    for key, value in part["properties"].items():
        kind = _type(value)
        lines.append(f"\n    {key}: {kind if key in part.get('required', ()) else f'NotRequired[{kind}]'}\n")
        if meaning := _meaning(value):
            lines.append(_documented(meaning))
    return "".join(lines)


def _meaning(value: dict[str, Any]) -> str:
    """What a field means, its unit, and its default where it is a short one."""
    parts = [value.get("description", "")]
    if "unit" in value:
        parts.append(f"in {value['unit']}" if value["unit"] != "1" else "a plain number")
    if value.get("default") is not None and len(json.dumps(value["default"])) < 30:
        parts.append(f"default {json.dumps(value['default'])}")
    return "; ".join(filter(None, parts))


def _documented(text: str) -> str:
    lines = textwrap.wrap(text, WIDTH - 8)
    closing = '"""' if len(lines) == 1 and not text.endswith('"') else '\n"""'
    return textwrap.indent('"""' + "\n".join(lines) + closing + "\n", "    ")


def _type(schema: dict[str, Any]) -> str:
    if "$ref" in schema:
        return str(schema["$ref"]).rpartition("/")[2]
    if "enum" in schema or "const" in schema:
        return f"Literal[{', '.join(json.dumps(word) for word in schema.get('enum', [schema.get('const')]))}]"
    if choices := schema.get("anyOf") or schema.get("oneOf"):
        return f"Union[{', '.join(dict.fromkeys(_type(choice) for choice in choices))}]"
    if schema["type"] == "array":
        entries = schema.get("prefixItems") or [schema["items"]]
        [entry] = dict.fromkeys(_type(entry) for entry in entries)
        return f"Sequence[{entry}]"
    return PLAIN[schema["type"]]


def _keys(value: dict[str, Any], parts: dict[str, dict[str, Any]], before: str = "") -> Iterator[str]:
    """The dotted keys below a value."""
    if "$ref" in value:
        value = parts[value["$ref"].rpartition("/")[2]]
    for choice in value.get("anyOf", []) + value.get("oneOf", []):
        yield from _keys(choice, parts, before)
    for name, below in value.get("properties", {}).items():
        yield before + name
        yield from _keys(below, parts, f"{before}{name}.")
