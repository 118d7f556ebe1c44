"""Planned motion against the truth: PyBullet's distances between the robot's collision meshes and what is there."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path as File
from typing import Self

import numpy as np

from backend.bench.course import Course, Problem, scene_of
from backend.bench.figure import Figure
from backend.kinematics import load_kinematics
from backend.kinematics.spheres import hand_joints
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots.models import load_model
from backend.sim.bullet import Bullet

ROOM_M = 0.03
"""With more clearance than this a posture should be called free."""
DEEP_M = 1e-3
"""Penetration that counts."""


class Truth:
    """The bodies of one trial in PyBullet, to measure distances between; nothing moves by itself."""

    def __init__(self, course: Course) -> None:
        description = course.description
        self.bullet = Bullet()
        self.kinematics = load_kinematics(description.robot)
        model = load_model(description.robot)
        home = np.array(model.description.home_rad)
        self.robot = self.bullet.add_robot(model, home, model.description.gripper.open_rad)
        self._target = self.bullet.add_object(load_object(description.object), course.T_world_object, fixed=True)
        T_tray_box = Pose.of((0.0, 0.0, -description.tray_size_m[2] / 2))
        self._tray = self.bullet.add_box(description.tray_size_m, course.T_world_tray @ T_tray_box)
        self._T_object_box = course.T_world_object.inverse() @ course.T_world_tray @ T_tray_box
        self._bodies = [self._target, self._tray]
        for name, T in zip(description.obstacles, course.Ts_world_obstacle, strict=True):
            self._bodies.append(self.bullet.add_object(load_object(name), Pose(T), fixed=True))
        if description.slab is not None:
            self._bodies.append(self.bullet.add_box(description.slab.size_m, description.slab.T_world_box))
        self._corners = mesh_corners(model.collision_urdf)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.bullet.close()

    def move_target(self, T_world_object: Pose) -> None:
        """Put the target elsewhere, and its tray with it."""
        self.bullet.set_pose(self._target, T_world_object)
        self.bullet.set_pose(self._tray, T_world_object @ self._T_object_box)

    def clearance_m(self, q: Array, within_m: float) -> float:
        """Least distance to bodies and floor, negative when the arm is in them, at most ``within_m``.

        What stands on the floor and only turns does not count there.
        """
        robot = self.kinematics.description
        self.robot.reset(q, robot.gripper.open_rad)
        near = [self.bullet.closest_distance_m(self.robot.body, body, within_m) for body in self._bodies]
        joints = dict(zip(robot.arm_joints, q.tolist(), strict=True))
        poses = self.kinematics.tree.link_poses(joints | hand_joints(robot.gripper, robot.gripper.open_rad))
        body_of = self.kinematics.chain.body_of_link
        heights = [
            float((corners @ poses[link][2, :3] + poses[link][2, 3]).min())
            for link, corners in self._corners.items()
            if body_of[link] > 1
        ]
        return min([within_m, *heights, *(distance for distance in near if distance is not None)])

    def self_clearance_m(self, q: Array, within_m: float = 0.0) -> float:
        """Least distance between links that may not touch, negative where they overlap, at most ``within_m``."""
        self.robot.reset(q, self.kinematics.description.gripper.open_rad)
        near = (sorted(pair) for pair in self.robot.self_contacts(within_m))
        distances = [self.bullet.link_distance_m(self.robot.body, a, b, within_m) for a, b in near]
        return min([within_m, *(distance for distance in distances if distance is not None)])


def mesh_corners(urdf: File) -> dict[str, Array]:
    """Link -> (n, 3) corners of its collision meshes in the link's frame."""
    import trimesh

    found: dict[str, list[Array]] = {}
    for link in ET.parse(urdf).getroot().findall("link"):
        for mesh in link.iterfind("collision/geometry/mesh"):
            corners = trimesh.load_mesh(urdf.parent / str(mesh.get("filename"))).vertices
            found.setdefault(str(link.get("name")), []).append(np.asarray(corners))
    return {name: np.concatenate(parts) for name, parts in found.items()}


def figures(
    courses: Sequence[Course],
    paths: Sequence[tuple[Course, Problem, Array]],
    postures: int,
    path_postures: int,
    rng: np.random.Generator,
) -> list[Figure]:
    """Random postures in the scenes of ``courses``, and postures (n, dof) along planned paths."""
    deep = roomy = refused = free = 0
    for course in courses:
        scene = scene_of(course)
        limits = scene.kinematics.limits
        qs = rng.uniform(limits[0], limits[1], size=(postures // len(courses), scene.kinematics.dof))
        called_free = scene.free_many(qs)
        with Truth(course) as truth:
            for q, is_free in zip(qs, called_free, strict=True):
                clearance_m = truth.clearance_m(q, ROOM_M)
                if is_free:
                    free += 1
                    deep += int(min(clearance_m, truth.self_clearance_m(q)) < -DEEP_M)
                if clearance_m >= ROOM_M and truth.self_clearance_m(q, ROOM_M) >= ROOM_M:
                    roomy += 1
                    refused += int(not is_free)
    along = clearances_m(paths, path_postures, rng)
    share = 100.0 * refused / roomy if roomy else float("nan")
    return [
        Figure("truth", "random postures called free that penetrate > 1 mm", deep, "", "<=", 0, free),
        Figure(
            "truth", "postures on paths that penetrate > 1 mm", int((along < -DEEP_M).sum()), "", "<=", 0, len(along)
        ),
        Figure("truth", "postures with > 3 cm clearance called blocked", share, "%", "<=", 5.0, roomy),
    ]


def clearances_m(paths: Sequence[tuple[Course, Problem, Array]], count: int, rng: np.random.Generator) -> Array:
    """(n,) true clearance from bodies and from itself of about ``count`` random postures along the paths (m, dof)."""
    found: list[float] = []
    share = count / max(1, len(paths))
    for course, of_course in itertools.groupby(paths, key=lambda entry: entry[0]):
        with Truth(course) as truth:
            for _, problem, waypoints in of_course:
                truth.move_target(problem.T_world_object)
                for q in _between(waypoints, int(share + rng.random()), rng):
                    found.append(min(truth.clearance_m(q, ROOM_M), truth.self_clearance_m(q)))
    return np.array(found)


def _between(waypoints: Array, count: int, rng: np.random.Generator) -> Array:
    marks = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(waypoints, axis=0), axis=1))])
    at = np.sort(rng.uniform(0.0, marks[-1], count))
    return np.column_stack([np.interp(at, marks, joint) for joint in waypoints.T])
