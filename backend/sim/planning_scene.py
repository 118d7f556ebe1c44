"""PlanningScene: what the planner believes stands around the robot, and what would touch it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backend.errors import InvalidInputError
from backend.kinematics import Kinematics
from backend.kinematics import collision as kernels
from backend.kinematics.bodies import BodyTable, box_shape, hull_shape
from backend.kinematics.chain import rows_of
from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose

MARGIN_M = 0.01
"""Distance kept from obstacles, slab and target: corners may poke in between two checked postures."""
SURFACE_MARGIN_M = 0.002
"""Distance kept from floor and tray, which low grasps must come close to."""
SELF_MARGIN_M = 0.0
RESOLUTION_RAD = 0.02
"""Largest motion of a joint between two checked postures of an edge."""
FAR_M = 1.0
"""Clearances are not told apart beyond this."""
AWAY_M = 1e3
"""So far off is what is not there."""
ELSEWHERE = Pose.of((AWAY_M, AWAY_M, AWAY_M))


@dataclass(frozen=True, eq=False)
class Target:
    """Where the target's bodies are in the table."""

    body: int
    tray: int
    T_object_tray: Pose


class PlanningScene:
    """Floor at z = 0, obstacles, slab, and the target on its tray; the robot is a set of spheres, hand open.

    What is called free is free of contact: the spheres hold the robot's meshes, bodies are never too small.
    """

    def __init__(
        self,
        kinematics: Kinematics,
        margin_m: float = MARGIN_M,
        surface_margin_m: float = SURFACE_MARGIN_M,
    ) -> None:
        self.kinematics = kinematics
        self._margin_m = margin_m
        self._margins = (surface_margin_m, SELF_MARGIN_M)
        self._table = BodyTable()
        self._obstacles: list[int] = []
        self._slab: int | None = None
        self._target: Target | None = None
        model = kinematics.spheres
        self._robot: kernels.RobotArrays = (
            kinematics.chain.links,
            model.nodes,
            model.skips,
            model.trees,
            model.pairs,
        )

    def add_object(self, description: ObjectDescription, T_world_object: Pose) -> int:
        """Add an obstacle; its index for ``move_obstacle``."""
        shape = hull_shape(description.name, description.convex_parts, kernels.OBSTACLE, self._margin_m)
        self._obstacles.append(self._table.add(shape, T_world_object))
        return len(self._obstacles) - 1

    def add_box(self, size_m: tuple[float, float, float], T_world_box: Pose, name: str = "slab") -> int:
        """Add a box around its centre; its index for ``move_obstacle``."""
        shape = box_shape(name, size_m, kernels.OBSTACLE, self._margin_m)
        self._obstacles.append(self._table.add(shape, T_world_box))
        return len(self._obstacles) - 1

    def move_obstacle(self, index: int, T_world_obstacle: Pose) -> None:
        """Put an obstacle elsewhere; raises ``InvalidInputError`` when there is no such obstacle."""
        if not 0 <= index < len(self._obstacles):
            raise InvalidInputError(
                f"There is no obstacle {index} in the planning scene; it has {len(self._obstacles)}."
            )
        self._table.move(self._obstacles[index], T_world_obstacle)

    def remove_obstacle(self, index: int) -> None:
        """Take an obstacle away; those after it move up by one. Raises like ``move_obstacle``."""
        self.move_obstacle(index, ELSEWHERE)
        del self._obstacles[index]

    def set_slab(self, size_m: tuple[float, float, float], T_world_box: Pose) -> None:
        """Hang a slab up, instead of the one there was."""
        self.remove_slab()
        self._slab = self._table.add(box_shape("slab", size_m, kernels.OBSTACLE, self._margin_m), T_world_box)

    def remove_slab(self) -> None:
        """Take the slab away, if there is one."""
        if self._slab is not None:
            self._table.move(self._slab, ELSEWHERE)
            self._slab = None

    def set_target(
        self,
        description: ObjectDescription,
        T_world_object: Pose,
        tray_size_m: tuple[float, float, float],
        T_world_tray: Pose,
    ) -> None:
        """Put the target on its tray (frame: middle of its top face). A scene has one target."""
        if self._target is not None:
            raise InvalidInputError("The planning scene has a target already; move it with move_target.")
        shape = hull_shape(description.name, description.convex_parts, kernels.TARGET, self._margin_m)
        tray = box_shape("tray", tray_size_m, kernels.TRAY, self._margins[0])
        T_tray_center = Pose.of((0.0, 0.0, -tray_size_m[2] / 2))
        self._target = Target(
            body=self._table.add(shape, T_world_object),
            tray=self._table.add(tray, T_world_tray @ T_tray_center),
            T_object_tray=T_world_object.inverse() @ T_world_tray @ T_tray_center,
        )

    def move_target(self, T_world_object: Pose) -> None:
        """Put the target elsewhere, and its tray with it."""
        target = self._the_target()
        self._table.move(target.body, T_world_object)
        self._table.move(target.tray, T_world_object @ target.T_object_tray)

    @contextmanager
    def without_target(self) -> Generator[None]:
        """As if target and tray were not there."""
        target = self._target
        rows = [] if target is None else [target.body, target.tray]
        before = self._table.arrays[0][rows]
        self._table.arrays[0][rows, 9:] += AWAY_M
        try:
            yield
        finally:
            self._table.arrays[0][rows] = before

    def is_free(self, q: Array, *, target: bool = True, hand_may_touch_target: bool = False) -> bool:
        """Whether posture ``q`` (dof,) rad touches nothing. ``target=False``: as if it were not there."""
        options = _options(target, hand_may_touch_target)
        return kernels.free(self._robot, self._table.arrays, self._margins, options, _row(q))

    def free_many(self, qs: Array, *, target: bool = True, hand_may_touch_target: bool = False) -> NDArray[np.bool_]:
        """(n,) whether each posture of (n, dof) is free."""
        options = _options(target, hand_may_touch_target)
        return kernels.free_each(self._robot, self._table.arrays, self._margins, options, _row(qs))

    def edge_free(self, q0: Array, q1: Array, resolution_rad: float = RESOLUTION_RAD) -> bool:
        """Whether the straight edge from ``q0``, which must be free, to ``q1`` is free of everything."""
        return self.edge_checks(q0, q1, resolution_rad) > 0

    def edge_checks(self, q0: Array, q1: Array, resolution_rad: float = RESOLUTION_RAD) -> int:
        """As ``edge_free``: the number of state checks it took, negative when the edge is blocked."""
        return kernels.edge_checks(
            self._robot,
            self._table.arrays,
            self._margins,
            kernels.WITH_TARGET,
            _row(q0),
            _row(q1),
            resolution_rad,
        )

    @property
    def arrays(self) -> tuple[kernels.RobotArrays, kernels.BodyArrays, kernels.Margins, int]:
        """What compiled planners read: robot, bodies, margins and options; of now, not to be kept or written to."""
        return self._robot, self._table.arrays, self._margins, kernels.WITH_TARGET

    def clearance_m(self, q: Array, *, target: bool = True, hand_may_touch_target: bool = False) -> float:
        """At most the distance to the nearest forbidden contact, at most ``FAR_M``; no margins."""
        options = _options(target, hand_may_touch_target)
        return kernels.smallest_distance(self._robot, self._table.arrays, options, FAR_M, _row(q))

    def why_blocked(self, q: Array, *, target: bool = True, hand_may_touch_target: bool = False) -> str:
        """Which link is too near to what, in words; empty when the posture is free."""
        return self.why_blocked_many(q[None], target=target, hand_may_touch_target=hand_may_touch_target)[0]

    def why_blocked_many(self, qs: Array, *, target: bool = True, hand_may_touch_target: bool = False) -> list[str]:
        """The same for each posture of (n, dof)."""
        options = _options(target, hand_may_touch_target)
        found = kernels.contact_each(self._robot, self._table.arrays, self._margins, options, _row(qs))
        return [self._words(kind, one, other) for kind, one, other in found.tolist()]

    def first_contact(
        self, qs: Array, Ts_world_object: Array, Ts_world_left: Array | None = None, *, in_hand: bool = False
    ) -> tuple[int, str] | None:
        """Which of successive postures (n, dof) touches anything first, and what, as the target moves on; None: none.

        By posture i the target is at ``Ts_world_object[i]`` (n, 4, 4), and its tray under it, or under
        ``Ts_world_left[i]``, where the target would be on it. ``in_hand``: the hand may touch the target.
        """
        target = self._the_target()
        Ts_on_tray = Ts_world_object if Ts_world_left is None else Ts_world_left
        rows = np.stack([rows_of(Ts_world_object), rows_of(Ts_on_tray @ target.T_object_tray.matrix)], axis=1)
        moving = np.array([target.body, target.tray])
        options = _options(True, in_hand)
        found = kernels.first_contact(
            self._robot, self._table.arrays, self._margins, options, _row(qs), moving, _row(rows)
        )
        return None if found[0] < 0 else (found[0], self._words(*found[1:]))

    def _the_target(self) -> Target:
        if self._target is None:
            raise InvalidInputError("The planning scene has no target yet; give it one with set_target.")
        return self._target

    def _words(self, kind: int, one: int, other: int) -> str:
        """What a kernel's ``contact`` means."""
        names = self.kinematics.spheres.names
        if kind == kernels.FLOOR:
            return f"{names[one]} too near to the floor"
        if kind == kernels.BODY:
            return f"{names[one]} too near to the {self._table.names[other]}"
        if kind == kernels.SELF:
            a, b = self.kinematics.spheres.pairs[one]
            return f"{names[a]} too near to {names[b]}"
        return ""


def _options(target: bool, hand_may_touch_target: bool) -> int:
    return kernels.WITH_TARGET * target | kernels.HAND_MAY_TOUCH * hand_may_touch_target


def _row(q: Array) -> Array:
    return np.ascontiguousarray(q, dtype=np.float64)
