"""What a field that does not exist was meant to be."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any, get_args

from pydantic import BaseModel

from service.cases.errors import CaseError, FieldError


def suggested(error: CaseError, whole: type[BaseModel]) -> CaseError:
    """The same faults; where a field of `whole` is unknown, with the name that is most like it."""
    return CaseError([_suggested(fault, whole) for fault in error.errors], error.more)


def _suggested(fault: FieldError, whole: type[BaseModel]) -> FieldError:
    if not fault.unknown or not fault.pointer:  # a field that is named as what tells kinds apart has no pointer
        return fault
    *path, name = (part.replace("~1", "/").replace("~0", "~") for part in fault.pointer.split("/")[1:])
    known = fields_at(whole, path)
    if name in known:  # of the kinds that may stand there
        return FieldError(fault.pointer, fault.value, f"{fault.rule} of this kind of {path[-1]}, but of another")
    return with_suggestion(fault, name, known)


def with_suggestion(fault: FieldError, name: str, names: Sequence[str]) -> FieldError:
    """The same fault, with the one of the known `names` that is most like the unknown `name`, if one is."""
    return FieldError(fault.pointer, fault.value, fault.rule + did_you_mean(name, names))


def did_you_mean(name: str, names: Sequence[str]) -> str:
    """The known name that is most like an unknown one, in whatever letters, as the end of a message; if one is."""
    spellings = {known.lower(): known for known in names}
    near = get_close_matches(name[:80].lower(), spellings, n=1)
    return f": did you mean {spellings[near[0]]}?" if near else ""


def fields_at(whole: type[BaseModel], path: Sequence[str]) -> list[str]:
    """The names of the fields that an object at this path within a model can have."""
    models = [whole]
    for part in path:
        if not part.isdigit():
            models = [inner for model in models if part in model.model_fields
                      for inner in _models(model.model_fields[part].annotation)]
    return sorted({name for model in models for name in model.model_fields})


def _models(annotation: Any) -> list[type[BaseModel]]:
    """The models among the kinds that a field may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]
