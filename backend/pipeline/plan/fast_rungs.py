"""The cheap rungs of ``fast``, compiled: which goal a straight edge reaches, from the start or the previous path."""

from __future__ import annotations

from backend.kinematics.compiled import kernel
from backend.pipeline.plan.edges import SceneArrays, edge_cost
from backend.pose import Array


@kernel
def still_free(scene: SceneArrays, first: Array, rest: Array) -> tuple[int, int]:
    """How many rows of ``rest`` (n, dof) follow from free ``first`` by free edges, and the state checks it took."""
    checks, count = 0, 0
    for i in range(rest.shape[0]):
        cost = edge_cost(scene, first if i == 0 else rest[i - 1], rest[i])
        checks += abs(cost)
        if cost < 0:
            break
        count += 1
    return count, checks


@kernel
def first_reached(scene: SceneArrays, start: Array, rest: Array, goals: Array) -> tuple[int, int, int]:
    """The first of ``goals`` (m, dof) that an edge reaches, from where, and the state checks it took.

    From where: how many rows of ``rest`` (n, dof), what lies ahead of the previous path, are followed before; as few
    as possible. (-1, 0, checks) when no goal is reached.
    """
    count, checks = -1, 0
    for g in range(goals.shape[0]):
        cost = edge_cost(scene, start, goals[g])
        checks += abs(cost)
        if cost > 0:
            return g, 0, checks
        if count < 0:
            count, cost = still_free(scene, start, rest)
            checks += cost
        for follow in range(count):
            cost = edge_cost(scene, rest[follow], goals[g])
            checks += abs(cost)
            if cost > 0:
                return g, follow + 1, checks
    return -1, 0, checks
