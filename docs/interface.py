"""The page of the HTTP interface, from its OpenAPI document: each operation, and each schema once, with links to it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from http import HTTPStatus
from typing import Any

from docs.fields import default_of, range_of
from docs.markers import markdown

Schema = dict[str, Any]
PROBLEM = "application/problem+json"


def page(document: dict[str, Any]) -> str:
    """The operations by tag, then the schemas, as Markdown."""
    parts = [document["info"]["description"]]
    for tag in document["tags"]:
        parts.append(f"## {tag['name']}\n\n{tag['description']}")
        parts += [_operation(method, path, one) for path, its in document["paths"].items()
                  for method, one in its.items() if tag["name"] in one["tags"]]  # fmt: skip
    parts.append("## Schemas")
    parts += [_schema(name, one) for name, one in sorted(document["components"]["schemas"].items())]
    return "\n\n".join(parts) + "\n"


def _operation(method: str, path: str, told: dict[str, Any]) -> str:
    parts = [f"### {method.upper()} {path}", told["description"]]
    if asked := told.get("parameters"):
        parts.append(markdown(("parameter", "in", "default", "value", "meaning"), [_parameter(one) for one in asked]))
    if body := told.get("requestBody"):
        parts += _body(body["content"])
    parts.append(markdown(("status", "answer", "meaning"), list(_answers(told["responses"]))))
    return "\n\n".join(parts)


def _parameter(told: dict[str, Any]) -> tuple[str, ...]:
    needed = "required" if told["required"] else _default(told["schema"])
    return f"`{told['name']}`", told["in"], needed, _value(told["schema"]), told["description"]


def _body(content: dict[str, Any]) -> Iterator[str]:
    for media, told in content.items():
        yield f"Body: `{media}`, {_type(told['schema'])}"
        for name, example in told.get("examples", {}).items():
            text = json.dumps(example["value"], indent=2)
            yield f"For example, {example.get('summary', name)}:\n\n```json\n{text}\n```"


def _answers(told: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """A row for each answer, but one for all errors that are told by their number alone."""
    errors = [status for status, one in told.items() if PROBLEM in one.get("content", {}) and _is_usual(status, one)]
    for status, one in told.items():
        if status not in errors:
            kinds = [f"`{media}`{_named(part)}" for media, part in one.get("content", {}).items()]
            yield status, " or ".join(kinds), one["description"]
    if errors:
        yield ", ".join(errors), f"`{PROBLEM}`: [Problem](#problem)", "an error"


def _is_usual(status: str, told: dict[str, Any]) -> bool:
    return bool(told["description"] == HTTPStatus(int(status)).phrase)


def _named(part: dict[str, Any]) -> str:
    said = _type(part.get("schema", {}))
    return f": {said}" if said else ""


def _schema(name: str, told: Schema) -> str:
    parts = [f"### {name}", told.get("description", "")]
    if rows := [_field(one, field, told) for one, field in told.get("properties", {}).items()]:
        parts.append(markdown(("field", "default", "unit", "value", "meaning"), rows))
    else:
        parts.append(_value(told))
    return "\n\n".join(part for part in parts if part)


def _field(name: str, field: Schema, of: Schema) -> tuple[str, ...]:
    needed = "required" if name in of.get("required", ()) else _default(field)
    return f"`{name}`", needed, field.get("unit", ""), _value(field), field.get("description", "")


def _default(schema: Schema) -> str:
    return default_of(schema) if "default" in schema else ""


def _value(schema: Schema) -> str:
    """Its type, and the rule for it."""
    if either := schema.get("anyOf") or schema.get("oneOf"):
        return " or ".join(dict.fromkeys(_value(one) for one in either if one.get("type") != "null"))
    return ", ".join(dict.fromkeys(part for part in (_type(schema), range_of(schema)) if part))


def _type(schema: Schema) -> str:
    """In words, with links to the schemas it names; nothing where its range says all."""
    if "anyOf" in schema or "oneOf" in schema:
        return _value(schema)
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return f"[{name}](#{name.lower()})"
    if schema.get("enum") or "const" in schema:
        return ""
    if schema.get("type") == "array":
        inner = dict.fromkeys(_type(one) for one in schema.get("prefixItems", [schema.get("items", {})]))
        return f"array of {' or '.join(one for one in inner if one) or 'values'}"
    if isinstance(schema.get("additionalProperties"), dict):
        return f"object of {_type(schema['additionalProperties']) or 'values'}"
    return str(schema.get("type", "")) + (f" ({schema['format']})" if "format" in schema else "")
