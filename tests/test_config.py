"""Config refuses what it does not know, and says what was wrong with it."""

import pytest
from pydantic import ValidationError

from backend.config import Config, NonNegativeFloat, PositiveFloat, Probability, explain


class Inner(Config):
    rate_hz: PositiveFloat = 20.0
    dropout: Probability = 0.0
    noise_m: NonNegativeFloat = 0.0


class Outer(Config):
    title: str
    inner: Inner = Inner()
    count: int = 0


def complaint_of(table: dict[str, object]) -> str:
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate(table)
    return explain(caught.value, "x.toml")


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
@pytest.mark.parametrize("key", ["rate_hz", "dropout", "noise_m"])
def test_what_is_not_a_number_is_refused(key: str, value: float):
    text = complaint_of({"title": "t", "inner": {key: value}})
    assert text == f"x.toml: inner.{key}: input should be a finite number (got {value!r})"


def test_an_unknown_key_is_named_with_its_path():
    text = complaint_of({"title": "t", "inner": {"rate": 3}})
    assert text == "x.toml: inner.rate: extra inputs are not permitted (got 3)"


def test_a_bound_is_named():
    text = complaint_of({"title": "t", "inner": {"rate_hz": 0}})
    assert text == "x.toml: inner.rate_hz: input should be greater than 0 (got 0)"


def test_every_mistake_has_its_line():
    text = complaint_of({"inner": {"dropout": 2.0}, "count": 1.5})
    assert text.splitlines() == [
        "x.toml: title: field required",
        "x.toml: inner.dropout: input should be less than or equal to 1 (got 2.0)",
        "x.toml: count: input should be a valid integer (got 1.5)",
    ]


@pytest.mark.parametrize(("key", "value"), [("title", 3), ("count", "3"), ("count", True), ("inner", 1.0)])
def test_types_are_not_bent(key: str, value: object):
    assert f"x.toml: {key}: input should be a valid" in complaint_of({"title": "t", key: value})


def test_a_config_cannot_change():
    config = Outer(title="t")
    with pytest.raises(ValidationError, match="frozen"):
        config.count = 3  # pyright: ignore[reportAttributeAccessIssue]


def test_json_keeps_everything():
    config = Outer(title="t", inner=Inner(rate_hz=7.25, dropout=1 / 3), count=4)
    assert Outer.model_validate_json(config.model_dump_json()) == config
