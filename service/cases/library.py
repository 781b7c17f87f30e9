"""Reading cases: the shipped ones and files, single settings, validation."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from service.cases.build import build_scene
from service.cases.case import CaseSpec
from service.cases.errors import CaseError, FieldError
from service.cases.slips import Slip
from service.cases.suggestions import did_you_mean, suggested

RESOLUTION = ("intervals", "dt_max", "increment_tolerance")
DEEPEST = 20
"""Parts of a dotted key; no field of a case lies half as deep."""
_SHIPPED = files("service.cases") / "shipped"


def shipped_cases() -> dict[str, str]:
    """Name and title of every case that comes with hockle, by name."""
    names = (file.name.removesuffix(".json") for file in _SHIPPED.iterdir())
    return {name: load_case(name)["title"] for name in sorted(names)}


def shipped_case(name: str) -> str:
    """The text of a shipped case. Raises CaseError where there is none of that name."""
    if name not in (names := shipped_cases()):
        rule = f"must be one of {', '.join(names)}{did_you_mean(name, list(names))}"
        raise CaseError([FieldError("", name, rule)])
    return (_SHIPPED / f"{name}.json").read_text(encoding="utf-8").rstrip()


def load_case(name_or_path: str | Path) -> dict[str, Any]:
    """The raw case of a shipped name or of a JSON file.

    Raises CaseError where there is neither, or where the text is not one JSON object without
    repeated names; OSError where the file cannot be read.
    """
    shipped = _SHIPPED / f"{name_or_path}.json"
    if "/" not in str(name_or_path) and shipped.is_file():
        return _read(shipped.read_text(encoding="utf-8"), str(name_or_path))
    path = Path(name_or_path)
    if not path.is_file():
        names = shipped_cases()
        hint = did_you_mean(path.name.removesuffix(".json"), list(names))
        rule = f"must be a file that is there, or one of {', '.join(names)}{hint}"
        raise CaseError([FieldError("", str(name_or_path), rule)])
    try:
        return _read(path.read_text(encoding="utf-8-sig"), str(path))
    except UnicodeDecodeError as error:
        fault = f"must be UTF-8 text in {path}, which byte {error.start} is not"
        raise CaseError([FieldError("", None, fault)]) from None


def apply_settings(raw: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
    """The raw case with some values set by dotted keys: `numerics.intervals`, `loads.point.0.s`.

    `raw` stays as it is, and shares with the result what is not set. A tolerance that is set takes the place of the
    case's own resolution, and a resolution that of its tolerance. Raises CaseError where a key leads into something
    that has no such place.
    """
    changed = dict(raw)
    if isinstance(changed.get("numerics"), dict):
        changed["numerics"] = dict(changed["numerics"])
    _displace(changed.get("numerics"), settings)
    for key, value in settings.items():
        path = key.split(".")
        if len(path) > DEEPEST:
            raise CaseError([FieldError("", key, f"must be a key of at most {DEEPEST} parts")])
        _set(changed, path, value)
    return changed


def parse_case(raw: Mapping[str, Any]) -> CaseSpec:
    """The case that raw JSON data describes; raises CaseError with every fault that was found."""
    try:
        spec = CaseSpec.model_validate_json(json.dumps(raw))
    except ValidationError as error:
        raise suggested(CaseError.of(error), CaseSpec) from None
    except (TypeError, ValueError) as error:
        raise CaseError([FieldError("", None, f"must be plain JSON data: {error}")]) from None
    build_scene(spec)
    return spec


def case_schema() -> dict[str, Any]:
    """The JSON schema of a case."""
    return CaseSpec.model_json_schema()


def _read(text: str, name: str) -> dict[str, Any]:
    try:
        raw = json.loads(text, object_pairs_hook=_without_repeats)
    except json.JSONDecodeError as error:
        slip = Slip.of(error)
        fault = f"is not JSON in {name}, {slip}\n  {slip.text}\n  {slip.mark}"
        raise CaseError([FieldError("", None, fault)]) from None
    except RecursionError:
        raise CaseError([FieldError("", None, f"must not be nested so deeply as in {name}")]) from None
    except ValueError as error:  # of a number of thousands of digits
        raise CaseError([FieldError("", None, f"is not JSON in {name}: {error}")]) from None
    if not isinstance(raw, dict):
        raise CaseError([FieldError("", None, f"must be a JSON object in {name}")])
    return raw


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    members: dict[str, Any] = {}
    for name, value in pairs:
        if name in members:
            raise CaseError([FieldError("", name, "must not hold a name twice in one object")])
        members[name] = value
    return members


def _displace(numerics: Any, settings: Mapping[str, Any]) -> None:
    """Remove from a case's own numerics what the settings replace."""
    if not isinstance(numerics, dict):
        return
    if settings.get("numerics.tolerance") is not None:
        for name in ("method", *RESOLUTION):
            numerics.pop(name, None)
    elif any(settings.get(f"numerics.{name}") is not None for name in RESOLUTION):
        numerics.pop("tolerance", None)


def _set(node: Any, path: list[str], value: Any) -> None:
    """Set the value at a path below a dict or list, making the objects on the way."""
    for depth, part in enumerate(path):
        place: Any = part
        if isinstance(node, list):
            if not (part.isdigit() and int(part) < len(node)):
                raise _no_place(path[:depth], f"has no entry {part!r} ({len(node)} entries)")
            place = int(part)
        elif not isinstance(node, dict):
            raise _no_place(path[:depth], f"is {node!r} and has no field {part!r} to set")
        if depth == len(path) - 1:
            node[place] = value
        else:
            node = _own(node, place)


def _own(node: Any, place: Any) -> Any:
    """What lies at a place of a dict or list, copied there first: the rest of a case is shared, not copied."""
    below = node.get(place, {}) if isinstance(node, dict) else node[place]
    if isinstance(below, (dict, list)):
        below = node[place] = below.copy()
    return below


def _no_place(path: list[str], rule: str) -> CaseError:
    return CaseError([FieldError("".join("/" + part for part in path), None, rule)])
