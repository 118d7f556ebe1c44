"""Raster: triangles into a picture, in compiled kernels: nearest surface per pixel, then light, shadow and floor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backend.kinematics.compiled import kernel
from backend.pose import Array

Ints = NDArray[np.int32]
NOTHING = -1
"""The face of a pixel without a surface."""
CELL_M, SECTION_M = 0.1, 0.5
FADE_FROM_M, FADE_TO_M = 1.0, 3.0
SHADOW, SHADOW_BIAS, GLOSS = 0.24, 0.004, 26.0
"""What a shadow takes from the floor; how far behind the nearest surface is still lit, in the map; glint, of 255."""


@kernel
def cover(corners: Array, faces: Ints, sheer: NDArray[np.bool_], nearness: Array, which: Ints) -> None:
    """Write into each pixel of (h, w) ``which`` the face (m, 3) that is nearest there, and how near.

    ``corners`` (n, 3): pixel x, pixel y, nearness, which is linear in the picture. Sheer faces take every second
    pixel. Faces behind the eye (nearness <= 0) are left out.
    """
    height, width = nearness.shape
    for face in range(faces.shape[0]):
        ax, ay, az = corners[faces[face, 0]]
        bx, by, bz = corners[faces[face, 1]]
        cx, cy, cz = corners[faces[face, 2]]
        if az <= 0.0 or bz <= 0.0 or cz <= 0.0:
            continue
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        left = max(int(np.ceil(min(ax, bx, cx) - 0.5)), 0)
        right = min(int(np.floor(max(ax, bx, cx) - 0.5)), width - 1)
        top = max(int(np.ceil(min(ay, by, cy) - 0.5)), 0)
        bottom = min(int(np.floor(max(ay, by, cy) - 0.5)), height - 1)
        for row in range(top, bottom + 1):
            y = row + 0.5
            for column in range(left, right + 1):
                if sheer[face] and (row + column) % 2 == 0:
                    continue
                x = column + 0.5
                u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
                v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                near = u * az + v * bz + w * cz
                if near > nearness[row, column]:
                    nearness[row, column] = near
                    which[row, column] = face


@kernel
def lay_ground(height: int, width: int, eye: Array, rays: Array, sun: Array, tones: Array) -> Array:
    """(height, width, 7) what pixels without a surface show: colour in full sun; share of it that a shadow takes; and
    where that shadow would be in the sun's map, x, y and nearness.

    Through pixel (x, y) of ``eye`` (3,) goes the ray ``rays @ (x, y, 1)``; ``sun`` as in ``Light``; ``tones`` (5, 3):
    sky above and below, floor, its cells, its sections.
    """
    ground = np.zeros((height, width, 7))
    ray, point = np.empty(3), np.empty(3)
    for row in range(height):
        for column in range(width):
            x, y = column + 0.5, row + 0.5
            for k in range(3):
                ray[k] = rays[k, 0] * x + rays[k, 1] * y + rays[k, 2]
                ground[row, column, k] = tones[0, k] + (tones[1, k] - tones[0, k]) * y / height
            if ray[2] >= 0.0:
                continue
            far = -eye[2] / ray[2]
            for k in range(3):
                point[k] = eye[k] + far * ray[k]
            point[2] = 0.0
            away = np.sqrt(point[0] ** 2 + point[1] ** 2)
            share = min(max((FADE_TO_M - away) / (FADE_TO_M - FADE_FROM_M), 0.0), 1.0)
            blur = far * np.sqrt(rays[0, 0] ** 2 + rays[1, 0] ** 2 + rays[2, 0] ** 2)
            cells, sections = 0.7 * _line(point, CELL_M, 0.0015, blur), _line(point, SECTION_M, 0.003, blur)
            for k in range(3):
                floor = tones[2, k] + cells * (tones[3, k] - tones[2, k])
                floor += sections * (tones[4, k] - floor)
                ground[row, column, k] += share * (floor - ground[row, column, k])
            ground[row, column, 3] = share * SHADOW
            for k in range(3):
                ground[row, column, 4 + k] = sun[k, 0] * point[0] + sun[k, 1] * point[1] + sun[k, 3]
    return ground


class Surface(NamedTuple):
    """Triangles in the world."""

    points: Array
    """(n, 3) corners."""
    normals: Array
    """(n, 3) of the corners."""
    faces: Ints
    """(m, 3)."""
    colors: Array
    """(m, 3) in 0..255."""


class Seen(NamedTuple):
    """What ``cover`` found."""

    corners: Array
    nearness: Array
    which: Ints
    eye: Array
    """(3,) in the world."""


class Light(NamedTuple):
    """What comes from where."""

    sun: Array
    """(4, 4): world to the sun's map, x, y and nearness in the first three rows, the direction to it in the last."""
    sun_map: Array
    """(size, size) nearness of what it meets first."""
    ground: Array
    """As ``lay_ground`` made it."""


@kernel
def shade(surface: Surface, seen: Seen, light: Light, finer: int) -> NDArray[np.uint8]:
    """(h / finer, w / finer, 3) picture, each pixel the mean of finer x finer of what is seen."""
    points, normals, faces, colors = surface
    corners, nearness, which, eye = seen
    sun, sun_map, ground = light
    height, width = nearness.shape
    picture = np.empty((height // finer, width // finer, 3), dtype=np.uint8)
    normal, point, color, ray, total = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(height // finer):
        for j in range(width // finer):
            total[:] = 0.0
            for row in range(i * finer, (i + 1) * finer):
                for column in range(j * finer, (j + 1) * finer):
                    face = which[row, column]
                    if face < 0:
                        dim = ground[row, column, 3]
                        if dim > 0.0:
                            spot = ground[row, column]
                            dim *= 1.0 - _lit(spot[4], spot[5], spot[6], sun_map)
                        for k in range(3):
                            total[k] += ground[row, column, k] * (1.0 - dim)
                        continue
                    x, y, near = column + 0.5, row + 0.5, nearness[row, column]
                    a, b, c = faces[face]
                    ax, ay, bx, by = corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
                    cx, cy = corners[c, 0], corners[c, 1]
                    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
                    u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area * corners[a, 2] / near
                    v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area * corners[b, 2] / near
                    w = 1.0 - u - v
                    for k in range(3):
                        point[k] = u * points[a, k] + v * points[b, k] + w * points[c, k]
                        normal[k] = u * normals[a, k] + v * normals[b, k] + w * normals[c, k]
                        ray[k] = point[k] - eye[k]
                        color[k] = colors[face, k]
                    _light(color, normal, point, ray, sun, sun_map)
                    for k in range(3):
                        total[k] += min(max(color[k], 0.0), 255.0)
            for k in range(3):
                picture[i, j, k] = np.uint8(total[k] / (finer * finer) + 0.5)
    return picture


@kernel
def _line(point: Array, spacing_m: float, width_m: float, blur_m: float) -> float:
    """How much of a pixel of size ``blur_m`` the lines of a grid cover."""
    most = 0.0
    for k in range(2):
        off = abs(point[k] / spacing_m - np.round(point[k] / spacing_m)) * spacing_m
        covered = min(max((0.5 * (width_m + blur_m) - off) / blur_m, 0.0), 1.0) * min(width_m / blur_m, 1.0)
        most = max(most, covered)
    return most


@kernel
def _lit(x: float, y: float, near: float, sun_map: Array) -> float:
    """Share of the light that comes to a place of the sun's map; its border is soft."""
    size = sun_map.shape[0]
    column, row = int(np.floor(x)), int(np.floor(y))
    if column < 1 or row < 1 or column >= size - 1 or row >= size - 1:
        return 1.0
    lit = 0
    for i in range(-1, 2):
        for j in range(-1, 2):
            lit += sun_map[row + i, column + j] <= near + SHADOW_BIAS
    return lit / 9.0


@kernel
def _light(color: Array, normal: Array, point: Array, ray: Array, sun: Array, sun_map: Array) -> None:
    """Sky from above, the sun, and a glint of it, onto a surface that is turned to face the eye."""
    light = sun[3, :3]
    length = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2) + 1e-12
    seen = np.sqrt(ray[0] ** 2 + ray[1] ** 2 + ray[2] ** 2)
    facing = -(normal[0] * ray[0] + normal[1] * ray[1] + normal[2] * ray[2]) / (length * seen)
    sign = 1.0 if facing >= 0.0 else -1.0
    brightness = 0.60 + 0.12 * sign * normal[2] / length + 0.08 * abs(facing)
    sunny = sign * (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]) / length
    glint = 0.0
    if sunny > 0.0:
        x = sun[0, 0] * point[0] + sun[0, 1] * point[1] + sun[0, 2] * point[2] + sun[0, 3]
        y = sun[1, 0] * point[0] + sun[1, 1] * point[1] + sun[1, 2] * point[2] + sun[1, 3]
        near = sun[2, 0] * point[0] + sun[2, 1] * point[1] + sun[2, 2] * point[2] + sun[2, 3]
        lit = _lit(x, y, near, sun_map)
        brightness += 0.36 * sunny * lit
        half_x, half_y, half_z = light[0] - ray[0] / seen, light[1] - ray[1] / seen, light[2] - ray[2] / seen
        half = np.sqrt(half_x**2 + half_y**2 + half_z**2) + 1e-12
        along = sign * (normal[0] * half_x + normal[1] * half_y + normal[2] * half_z) / (length * half)
        glint = GLOSS * lit * max(along, 0.0) ** 30
    for k in range(3):
        color[k] = color[k] * brightness + glint
