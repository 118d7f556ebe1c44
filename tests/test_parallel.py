"""Work spread over processes: every job is done once, and what goes wrong is said."""

import operator
from functools import partial

import pytest

from backend.parallel import spread


@pytest.mark.parametrize("workers", [1, 2])
def test_every_job_is_done_once(workers: int):
    assert sorted(spread(operator.neg, range(20), workers)) == list(range(-19, 1))


@pytest.mark.parametrize("workers", [1, 2])
def test_what_a_job_raises_is_raised_here(workers: int):
    with pytest.raises(ZeroDivisionError):
        list(spread(partial(operator.floordiv, 1), [4, 0, 9], workers))
