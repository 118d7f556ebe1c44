"""Reasons: why grasps are out, put into words only when somebody reads one."""

from collections.abc import Callable, Iterable, Iterator, Mapping


class Reasons(Mapping[int, str]):
    """Index -> reason. Every cycle rejects most of a database, and few of the reasons are ever read."""

    def __init__(self, indices: Iterable[int], why: Callable[[int], str]) -> None:
        self._indices = dict.fromkeys(indices)
        self._why = why

    def __getitem__(self, index: int) -> str:
        if index not in self._indices:
            raise KeyError(index)
        return self._why(index)

    def __iter__(self) -> Iterator[int]:
        return iter(self._indices)

    def __len__(self) -> int:
        return len(self._indices)

    def __contains__(self, index: object) -> bool:
        return index in self._indices

    def __reduce__(self) -> tuple[type[dict[int, str]], tuple[dict[int, str]]]:
        """To other processes they go in words."""
        return dict, (dict(self),)


def with_others(reasons: Mapping[int, str], others: Mapping[int, str]) -> Mapping[int, str]:
    """Both; where both have a reason, that of ``others``."""
    if not others:
        return reasons
    return Reasons([*reasons, *others], lambda index: others[index] if index in others else reasons[index])
