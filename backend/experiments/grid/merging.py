"""Merging: the rows of several stores of one grid, shards or parts run elsewhere, in one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from backend.errors import InvalidInputError, NotFoundError
from backend.experiments.grid.folder import plan_of, salvaged, shard_files, store_file, trials_of
from backend.experiments.grid.store import Facts, Store, differing, open_store, read_store


@dataclass
class Merged:
    """What a merge came to."""

    files: int = 0
    added: int = 0
    there_already: int = 0
    """Rows that were there, and the same."""


def merge(folder: Path, others: list[Path], *, salvage: bool = False) -> Merged:
    """Put the shards of ``folder`` and every store of the other folders into ``folder``'s own.

    With ``salvage``, also what can be read of corrupt ones. Raises ``InvalidInputError`` for other settings, and for
    rows of the same trial that differ, and ``NotFoundError`` when there is nothing to merge.
    """
    files = [*shard_files(folder), *(file for other in others for file in _files(other))]
    if not files:
        raise NotFoundError(f"There are no shards in {folder}; name the folders to merge into it.")
    merged = Merged()
    own = store_file(folder)
    with open_store(own, _most_trials([*files, own] if own.is_file() else files, salvage)) as target:
        for file in files:
            with read_store(file, even_broken=salvage) as source:
                _pour(source, target, merged, salvage)
    return merged


def _most_trials(files: list[Path], salvage: bool) -> Facts:
    """Facts of the file whose grid has the most trials; the others' are among them, or it will be said that not."""
    facts = list[Facts]()
    for file in files:
        with read_store(file, even_broken=salvage) as source:
            facts.append(source.facts)
    return max(facts, key=trials_of)


def _files(folder: Path) -> list[Path]:
    files = [file for file in (store_file(folder), *shard_files(folder)) if file.is_file()]
    if not files:
        raise NotFoundError(f"There are no rows of a grid in {folder}.")
    return files


def _pour(source: Store, target: Store, merged: Merged, salvage: bool) -> None:
    if source.path.resolve() == target.path.resolve():
        return
    if lines := differing(source.facts, target.facts):
        raise InvalidInputError(f"{source.path} is of another grid than {target.path}:\n  " + "\n  ".join(lines))
    there = target.keys()
    rows = salvaged(source, plan_of(source.facts).trials) if salvage else source.rows()
    merged.files += 1
    for row in rows:
        if row.key not in there:
            target.add(row)
            merged.added += 1
        elif target.row(row.key).sure() == row.sure():
            merged.there_already += 1
        else:
            raise InvalidInputError(
                f"{source.path} and {target.path} have different rows of {row.key}: was one made with other code?"
            )
