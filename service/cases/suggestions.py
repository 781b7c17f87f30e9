"""What a field that does not exist was meant to be, and where it belongs; and what a list must hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import cache
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from service.cases.errors import CaseError, FieldError
from service.cases.other_names import kind_named_otherwise, named_otherwise, not_there

LIKE, ALIKE = 0.6, 0.8
"""How much of its letters a name shares with one that is like it; and with one that it is likely a slip of."""
MOST_PLACES = 3
"""Places of fields of one name that are told."""


def suggested(error: CaseError, whole: type[BaseModel]) -> CaseError:
    """The same faults; where a field of `whole` is unknown, with the name or the place that was likely meant; and where
    there is no list, with what it must be of. What is missing is not told where all that must be there is missing, and
    what stands there instead is told."""
    wrapped = [fault for fault in error.errors if fault.unknown and _wraps(fault, whole)]
    if wrapped:
        return CaseError([replace(fault, rule=f"{fault.rule}: send what it holds by itself") for fault in wrapped])
    faults = [fault for fault in error.errors if not (fault.missing and _is_another(fault, error.errors, whole))]
    return CaseError([_suggested(fault, whole) for fault in faults], error.more)


def _is_another(fault: FieldError, faults: Sequence[FieldError], whole: type[BaseModel]) -> bool:
    """Whether the object in which a field is missing has none of those that it must have, but others."""
    place = fault.pointer.rpartition("/")[0]
    beside = [other for other in faults if other.pointer.rpartition("/")[0] == place]
    missing = {other.pointer.rpartition("/")[2] for other in beside if other.missing}
    models = _models_at(whole, place.split("/")[1:])
    return any(other.unknown for other in beside) and any(_required(model) == missing for model in models)


def _required(model: type[BaseModel]) -> set[str]:
    return {name for name, field in model.model_fields.items() if field.is_required()}


def _wraps(fault: FieldError, whole: type[BaseModel]) -> bool:
    """Whether an unknown field of the whole holds what the whole must be."""
    return fault.pointer.count("/") == 1 and isinstance(fault.value, dict) and _required(whole) <= set(fault.value)


def _suggested(fault: FieldError, whole: type[BaseModel]) -> FieldError:
    if kind := kind_named_otherwise(fault.value, fault.rule):
        return FieldError(fault.pointer, fault.value, f"{fault.rule}: did you mean {kind}?")
    if not fault.pointer or not (fault.unknown or fault.no_list):  # what is named as a kind of value has no pointer
        return fault
    *path, name = (part.replace("~1", "/").replace("~0", "~") for part in fault.pointer.split("/")[1:])
    if fault.no_list:
        listed = fault.rule.replace("a list", f"a list{_entries(whole, [*path, name])}", 1)
        return FieldError(fault.pointer, fault.value, listed)
    known = fields_at(whole, path)
    if name in known:  # of the kinds that may stand there
        return FieldError(fault.pointer, fault.value, f"{fault.rule} of this kind of {path[-1]}, but of another")
    instead = not_there(name, path, known)
    if instead:
        return FieldError(fault.pointer, fault.value, f"{fault.rule}: {instead}")
    meant = named_otherwise(name, known)
    if meant:
        return FieldError(fault.pointer, fault.value, f"{fault.rule}: did you mean {meant}?")
    hint = did_you_mean(name, known, ALIKE) or _elsewhere(name, path, whole) or did_you_mean(name, known)
    return FieldError(fault.pointer, fault.value, fault.rule + hint)


def with_suggestion(fault: FieldError, name: str, names: Sequence[str]) -> FieldError:
    """The same fault, with the one of the known `names` that is most like the unknown `name`, if one is."""
    return FieldError(fault.pointer, fault.value, fault.rule + did_you_mean(name, names))


def did_you_mean(name: str, names: Sequence[str], least: float = LIKE) -> str:
    """The known name that is most like an unknown one, in whatever letters, as the end of a message; if one is."""
    spellings = {known.lower(): known for known in names}
    near = get_close_matches(name[:80].lower(), spellings, n=1, cutoff=least)
    return f": did you mean {spellings[near[0]]}?" if near else ""


def fields_at(whole: type[BaseModel], path: Sequence[str]) -> list[str]:
    """The names of the fields that an object at this path within a model can have."""
    return sorted({name for model in _models_at(whole, path) for name in model.model_fields})


def _entries(whole: type[BaseModel], path: Sequence[str]) -> str:
    """What the list at this path must hold, as the end of a message: so many entries, or objects; if that is known."""
    kinds = _lists_at(whole, path)
    counts = sorted({len(kind) for kind in kinds if ... not in kind})
    if counts:
        return f" of {' or '.join(map(str, counts))} entries"
    return " of objects: [{...}]" if any(_models(kind[0]) for kind in kinds) else ""


def _lists_at(whole: type[BaseModel], path: Sequence[str]) -> list[tuple[Any, ...]]:
    """What the lists hold that may stand at this path within a model."""
    *above, name = path
    if name.isdigit():
        return [inner for kind in _lists_at(whole, above) for inner in _lists(kind[0])]
    return [kind for model in _models_at(whole, above) if name in model.model_fields
            for kind in _lists(model.model_fields[name].annotation)]  # fmt: skip


def _lists(annotation: Any) -> list[tuple[Any, ...]]:
    """What the lists hold that a field may be: `...` after what may stand in them any number of times."""
    parts = get_args(annotation)
    return [parts] if get_origin(annotation) is tuple else [kind for part in parts for kind in _lists(part)]


def _models_at(whole: type[BaseModel], path: Sequence[str]) -> list[type[BaseModel]]:
    """The models that may stand at this path within a model."""
    models = [whole]
    for part in path:
        if not part.isdigit():
            models = [inner for model in models if part in model.model_fields
                      for inner in _models(model.model_fields[part].annotation)]
    return models


def _elsewhere(name: str, path: Sequence[str], whole: type[BaseModel]) -> str:
    """Where a field of this name belongs, which stands at this path, as the end of a message; if there are few such
    places, or all of them are in lists of one name: there in which objects, if it is in such a list already."""
    places = _places(whole).get(name, ())
    if 0 < len(places) <= MOST_PLACES:
        return f" here: its place is {' or '.join(places)}"
    lists = {place.rpartition(".0.")[0].rpartition(".")[2] for place in places}
    if len(lists) != 1 or "" in lists:
        return ""
    inner = dict.fromkeys(place.split(".")[-2] for place in places) if lists <= set(path) else lists
    return f" here: its place is in {', '.join(inner)}"


@cache
def _places(whole: type[BaseModel]) -> dict[str, tuple[str, ...]]:
    """The dotted keys at which a field of each name may stand; of lists, those of the first entry."""
    found: dict[str, tuple[str, ...]] = {}
    left: list[tuple[str, type[BaseModel]]] = [("", whole)]
    while left:
        above, model = left.pop(0)
        for name, field in model.model_fields.items():
            key = above + name
            found[name] = tuple(dict.fromkeys((*found.get(name, ()), key)))
            listed = ".0" if _lists(field.annotation) else ""
            left += [(f"{key}{listed}.", inner) for inner in _models(field.annotation)]
    return found


def _models(annotation: Any) -> list[type[BaseModel]]:
    """The models among the kinds that a field may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]
