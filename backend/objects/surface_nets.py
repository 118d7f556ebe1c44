"""Surface nets: a closed smooth mesh of the region where a function of space is negative (Gibson 1998)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backend.objects.mesh import Mesh
from backend.pose import Array

CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
EDGES = tuple((a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1)


def surface_of(field: Callable[[Array, Array], Array], low_m: Array, high_m: Array, cell_m: float) -> Mesh:
    """Watertight mesh of ``field(plane (n, 2), heights (m,)) -> (n, m) < 0``, one vertex per crossed cell.

    ``low_m`` and ``high_m`` are (3,) corners of a box that holds the shape; the grid is centred in it, and
    reaches at least one cell beyond.
    """
    counts = np.ceil((high_m - low_m) / cell_m).astype(int) + 3
    origin = (low_m + high_m - (counts - 1) * cell_m) / 2
    x, y, z = (start + cell_m * np.arange(n) for start, n in zip(origin, counts, strict=True))
    plane = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    values = field(plane, z).reshape(tuple(counts))
    cells, vertices = _vertices(values)
    number = np.full(values.shape, -1, dtype=np.int64)
    number[tuple(cells.T)] = np.arange(len(cells))
    quads = np.concatenate([_quads(values, number, axis) for axis in range(3)])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Mesh(origin + vertices * cell_m, faces)


def _vertices(values: Array) -> tuple[NDArray[np.int64], Array]:
    """Crossed cells (n, 3) and, in grid units, the mean (n, 3) of the crossings on each one's edges."""
    nx, ny, nz = (n - 1 for n in values.shape)
    corners = np.stack([values[i : i + nx, j : j + ny, k : k + nz] for i, j, k in CORNERS], axis=-1)
    inside = corners < 0
    cells = np.argwhere(inside.any(axis=-1) & ~inside.all(axis=-1))
    at = corners[tuple(cells.T)]
    total, crossings = np.zeros((len(cells), 3)), np.zeros((len(cells), 1))
    for a, b in EDGES:
        crossed = (at[:, a] < 0) != (at[:, b] < 0)
        u = np.where(crossed, at[:, a] / np.where(crossed, at[:, a] - at[:, b], 1.0), 0.0)[:, None]
        total += crossed[:, None] * (CORNERS[a] + u * (CORNERS[b] - CORNERS[a]))
        crossings += crossed[:, None]
    return cells, cells + total / crossings


def _quads(values: Array, number: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """(n, 4) vertices around every grid edge along ``axis`` whose ends lie on different sides."""
    step = np.eye(3, dtype=int)
    along, u, v = step[axis], step[(axis + 1) % 3], step[(axis + 2) % 3]
    ahead = np.take(values, range(1, values.shape[axis]), axis)
    behind = np.take(values, range(values.shape[axis] - 1), axis)
    edges = np.argwhere((ahead < 0) != (behind < 0))
    corner = [number[tuple((edges - offset).T)] for offset in (0 * along, u, u + v, v)]
    quads = np.stack(corner, axis=1)
    outward = values[tuple(edges.T)] < 0
    quads[~outward] = quads[~outward][:, ::-1]
    return quads
