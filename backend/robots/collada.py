"""A reader for the plain COLLADA files of robot descriptions: triangles with one diffuse colour each.

Coordinates are taken as written: the ``up_axis`` that exporters put into these files is not meant for URDF.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from backend.errors import InvalidInputError
from backend.pose import Array

Rgba = tuple[float, float, float, float]
N = "{http://www.collada.org/2005/11/COLLADASchema}"


def read_collada(path: Path) -> list[tuple[trimesh.Trimesh, Rgba | None]]:
    """Every mesh with its colour (None where the file gives none), in the file's own unit and axes."""
    document = ET.parse(path).getroot()
    colors = _material_colors(document)
    geometries = {str(g.get("id")): g for g in document.iter(f"{N}geometry")}
    parts: list[tuple[trimesh.Trimesh, Rgba | None]] = []
    for scene in document.iter(f"{N}visual_scene"):
        for node in scene.findall(f"{N}node"):
            _collect(node, np.eye(4), geometries, colors, parts)
    if not parts:
        raise InvalidInputError(f"{path}: no triangles that this reader understands.")
    return parts


def _collect(
    node: ET.Element,
    T_scene_parent: Array,
    geometries: dict[str, ET.Element],
    colors: dict[str, Rgba],
    parts: list[tuple[trimesh.Trimesh, Rgba | None]],
) -> None:
    T_scene_node = T_scene_parent @ _node_transform(node)
    for instance in node.findall(f"{N}instance_geometry"):
        geometry = geometries[str(instance.get("url"))[1:]]
        bound = {str(m.get("symbol")): str(m.get("target"))[1:] for m in instance.iter(f"{N}instance_material")}
        for mesh, symbol in _geometry_meshes(geometry):
            mesh.apply_transform(T_scene_node)
            parts.append((mesh, colors.get(bound.get(symbol, symbol))))
    for child in node.findall(f"{N}node"):
        _collect(child, T_scene_node, geometries, colors, parts)


def _node_transform(node: ET.Element) -> Array:
    product = np.eye(4)
    for element in node:
        values = np.array((element.text or "").split(), dtype=np.float64) if element.text else np.zeros(0)
        step = np.eye(4)
        if element.tag == f"{N}matrix":
            step = values.reshape(4, 4)
        elif element.tag == f"{N}translate":
            step[:3, 3] = values
        elif element.tag == f"{N}scale":
            step[:3, :3] = np.diag(values)
        elif element.tag == f"{N}rotate":
            step = np.asarray(trimesh.transformations.rotation_matrix(np.radians(values[3]), values[:3]))
        product = product @ step
    return product


def _geometry_meshes(geometry: ET.Element) -> list[tuple[trimesh.Trimesh, str]]:
    arrays = {
        str(source.get("id")): np.array((a.text or "").split(), dtype=np.float64).reshape(-1, 3)
        for source in geometry.iter(f"{N}source")
        if (a := source.find(f"{N}float_array")) is not None and int(a.get("count", "0")) % 3 == 0
    }
    vertices_of = {
        str(v.get("id")): str(i.get("source"))[1:]
        for v in geometry.iter(f"{N}vertices")
        for i in v.findall(f"{N}input")
        if i.get("semantic") == "POSITION"
    }
    meshes: list[tuple[trimesh.Trimesh, str]] = []
    for tag in ("triangles", "polylist"):
        for primitive in geometry.iter(f"{N}{tag}"):
            source, faces = _faces(primitive)
            if len(faces):
                mesh = trimesh.Trimesh(arrays[vertices_of[source]], faces, process=False)
                mesh.remove_unreferenced_vertices()
                meshes.append((mesh, str(primitive.get("material"))))
    return meshes


def _faces(primitive: ET.Element) -> tuple[str, NDArray[np.int64]]:
    """Id of the vertices element, and (n, 3) indices; polygons become fans."""
    inputs = primitive.findall(f"{N}input")
    stride = 1 + max(int(i.get("offset", "0")) for i in inputs)
    vertex = next(i for i in inputs if i.get("semantic") == "VERTEX")
    flat = np.array(" ".join(p.text or "" for p in primitive.findall(f"{N}p")).split(), dtype=np.int64)
    corners = flat.reshape(-1, stride)[:, int(vertex.get("offset", "0"))]
    counts = primitive.find(f"{N}vcount")
    if counts is None:
        faces = corners.reshape(-1, 3)
    else:
        starts = np.cumsum([0, *map(int, (counts.text or "").split())])
        fans = [(corners[a], corners[i], corners[i + 1]) for a, b in pairwise(starts) for i in range(a + 1, b - 1)]
        faces = np.array(fans, dtype=np.int64).reshape(-1, 3)
    return str(vertex.get("source"))[1:], faces


def _material_colors(document: ET.Element) -> dict[str, Rgba]:
    effects: dict[str, Rgba] = {}
    for effect in document.iter(f"{N}effect"):
        color = effect.find(f".//{N}diffuse/{N}color")
        if color is not None and color.text:
            r, g, b, a = (*(float(v) for v in color.text.split()), 1.0)[:4]
            effects[str(effect.get("id"))] = (r, g, b, a)
    return {
        str(material.get("id")): effects[effect_id]
        for material in document.iter(f"{N}material")
        for i in material.findall(f"{N}instance_effect")
        if (effect_id := str(i.get("url"))[1:]) in effects
    }
