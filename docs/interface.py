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
        parts += [_operation(method, path, operation) for path, operations in document["paths"].items()
                  for method, operation in operations.items() if tag["name"] in operation["tags"]]  # fmt: skip
    parts.append("## Schemas")
    parts += [_schema(name, schema) for name, schema in sorted(document["components"]["schemas"].items())]
    return "\n\n".join(parts) + "\n"


def _operation(method: str, path: str, operation: dict[str, Any]) -> str:
    parts = [f"### {method.upper()} {path}", operation["description"]]
    if parameters := operation.get("parameters"):
        parts.append(markdown(("parameter", "in", "default", "value", "meaning"), list(map(_parameter, parameters))))
    if body := operation.get("requestBody"):
        parts += _body(body["content"])
    parts.append(markdown(("status", "answer", "meaning"), list(_answers(operation["responses"]))))
    return "\n\n".join(parts)


def _parameter(parameter: dict[str, Any]) -> tuple[str, ...]:
    default = "required" if parameter["required"] else _default(parameter["schema"])
    return f"`{parameter['name']}`", parameter["in"], default, _value(parameter["schema"]), parameter["description"]


def _body(content: dict[str, Any]) -> Iterator[str]:
    for media, media_type in content.items():
        yield f"Body: `{media}`, {_type(media_type['schema'])}"
        for name, example in media_type.get("examples", {}).items():
            text = json.dumps(example["value"], indent=2)
            yield f"For example, {example.get('summary', name)}:\n\n```json\n{text}\n```"


def _answers(responses: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """A row for each answer, but one for all errors that say no more than their number."""
    errors = [status for status, response in responses.items()
              if PROBLEM in response.get("content", {}) and _is_usual(status, response)]  # fmt: skip
    for status, response in responses.items():
        if status not in errors:
            kinds = [f"`{media}`{_type_suffix(part)}" for media, part in response.get("content", {}).items()]
            yield status, " or ".join(kinds), response["description"]
    if errors:
        yield ", ".join(errors), f"`{PROBLEM}`: [Problem](#problem)", "an error"


def _is_usual(status: str, response: dict[str, Any]) -> bool:
    return bool(response["description"] == HTTPStatus(int(status)).phrase)


def _type_suffix(part: dict[str, Any]) -> str:
    type_text = _type(part.get("schema", {}))
    return f": {type_text}" if type_text else ""


def _schema(name: str, schema: Schema) -> str:
    parts = [f"### {name}", schema.get("description", "")]
    if rows := [_field(field_name, field, schema) for field_name, field in schema.get("properties", {}).items()]:
        parts.append(markdown(("field", "default", "unit", "value", "meaning"), rows))
    else:
        parts.append(_value(schema))
    return "\n\n".join(part for part in parts if part)


def _field(name: str, field: Schema, schema: Schema) -> tuple[str, ...]:
    default = "required" if name in schema.get("required", ()) else _default(field)
    return f"`{name}`", default, field.get("unit", ""), _value(field), field.get("description", "")


def _default(schema: Schema) -> str:
    return default_of(schema) if "default" in schema else ""


def _value(schema: Schema) -> str:
    """Its type, and the rule for it."""
    if choices := schema.get("anyOf") or schema.get("oneOf"):
        return " or ".join(dict.fromkeys(_value(choice) for choice in choices if choice.get("type") != "null"))
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
        inner = dict.fromkeys(_type(entry) for entry in schema.get("prefixItems", [schema.get("items", {})]))
        return f"array of {' or '.join(filter(None, inner)) or 'values'}"
    if isinstance(schema.get("additionalProperties"), dict):
        return f"object of {_type(schema['additionalProperties']) or 'values'}"
    return str(schema.get("type", "")) + (f" ({schema['format']})" if "format" in schema else "")
