"""Roadmap against scipy's graph search."""

import itertools

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, shortest_path

from backend.pipeline.plan.roadmap import Roadmap


def test_a_roadmap_joins_what_a_graph_library_joins():
    rng = np.random.default_rng(2)
    qs = rng.normal(size=(60, 6))
    edges = rng.integers(60, size=(45, 2))
    roadmap = Roadmap()
    for i, j in edges:
        roadmap.join(qs[i], qs[j])
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(60, 60))
    parts, part_of = connected_components(graph, directed=False)
    steps = shortest_path(graph.tocsr(), directed=False, unweighted=True)
    linked = {frozenset(edge) for edge in edges.tolist()}
    assert 5 < parts < 40
    for i in range(60):
        for j in range(60):
            way = roadmap.way(qs[i], qs[j])
            assert roadmap.joined(qs[i], qs[j]) == (way is not None) == (part_of[i] == part_of[j])
            if way is not None:
                nodes = [int(np.flatnonzero((qs == q).all(axis=1))[0]) for q in way]
                assert nodes[0] == i and nodes[-1] == j and len(nodes) == steps[i, j] + 1
                assert all(frozenset(pair) in linked for pair in itertools.pairwise(nodes))
