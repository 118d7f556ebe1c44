"""Which settings exist at any place of a scenario, read off the models themselves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_args

from pydantic import BaseModel

Model = type[BaseModel]


def models_in(annotation: Any) -> list[Model]:
    """Every model that a field of this type may hold."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in models_in(part)]


def of_kind(models: Sequence[Model], kind: object) -> Model | None:
    """The only model, or that of several whose ``kind`` it is."""
    if len(models) == 1:
        return models[0]
    return next((m for m in models if "kind" in m.model_fields and m.model_fields["kind"].default == kind), None)


def model_at(model: Model, location: Sequence[str | int]) -> Model | None:
    """The model at a place as pydantic's errors name it: field names, list indices and kinds."""
    names = [part for part in location if isinstance(part, str)]
    here: Model | None = model
    while names and here is not None:
        field = here.model_fields.get(names.pop(0))
        options = [] if field is None else models_in(field.annotation)
        here = of_kind(options, names.pop(0) if names and len(options) > 1 else None)
    return here
