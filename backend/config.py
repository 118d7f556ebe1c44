"""Config: the strict, frozen base of everything a scenario file may say."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError


class Config(BaseModel):
    """Unknown keys, wrong types, NaN and infinity are refused; instances cannot change.

    What stands below a field in quotes is its description: the page shows it beside the field.
    """

    model_config = ConfigDict(
        frozen=True, strict=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )


PositiveFloat = Annotated[float, Field(gt=0.0)]
NonNegativeFloat = Annotated[float, Field(ge=0.0)]
Probability = Annotated[float, Field(ge=0.0, le=1.0)]


def explain(error: ValidationError, where: str = "") -> str:
    """Every complaint of pydantic as one line each: ``where: path.to.key: message (got value)``."""
    prefix = f"{where}: " if where else ""
    return "\n".join(prefix + complaint(entry) for entry in error.errors(include_url=False))


def complaint(entry: Any) -> str:
    """One line for one of pydantic's error details."""
    path = ".".join(str(part) for part in entry["loc"])
    message = str(entry["msg"])
    text = f"{path}: {message[0].lower()}{message[1:]}" if path else message
    value = entry["input"]
    return text if isinstance(value, dict) else f"{text} (got {value!r})"
