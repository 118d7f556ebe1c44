"""Rig: one hand without an arm and one object on its tray, to try grasps as they are carried out at run time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Self

import numpy as np

from backend.methods.method import Execution
from backend.objects import ObjectDescription
from backend.pipeline.execute import CLOSE_AT_MOST_S, SHORTEST_LIFT_S, Closing, lift_way
from backend.pipeline.execute.blend import to_zero
from backend.pose import Array, Pose
from backend.robots.models import RobotModel
from backend.sim.bullet import SOLVER_ITERATIONS, STEP_S, Bullet, GripperDrive
from backend.tasks.setup import tray_size_m

SETTLE_STEPS = 60
STATION_M = 0.005
"""On the way in the hand's distance to everything is looked at so often."""
FINGER_M = 0.13
"""No point of a finger is further from the axis it turns about."""
MOST_GAP_M = 0.05
SAFE_GAP_M = 0.004
"""Fingers nearer to something than this are left to the physics."""


@dataclass(frozen=True)
class RigSettings:
    """How a grasp is carried out and judged."""

    execution: Execution = field(default_factory=Execution)
    """Approach, closing and lift, as at run time."""
    close_at_most_s: float = CLOSE_AT_MOST_S
    lift_s: float = SHORTEST_LIFT_S
    solver_iterations: int = SOLVER_ITERATIONS
    hold_s: float = 0.3
    fell_m: float = 0.005
    """The object may sink by this much while it is held."""
    short_m: float = 0.04
    """The object may rise by this much less than the hand."""
    clear_m: float = 0.004
    """Least distance of the open hand to the object on the way in, for a candidate."""
    tray_clear_m: float = 0.004
    """Least distance of the open hand to tray and floor on the way in, for a candidate."""


@dataclass(frozen=True)
class Attempted:
    """How an attempt ended."""

    held: bool
    why: str = ""
    """Why not, in a few words."""
    slip_m: float = float("inf")
    """How far the object moved in the hand from the end of the closing to the end of the hold."""


class Rig:
    """Every attempt begins with the object at rest on its tray; same arguments, same outcome.

    A belt that runs at a constant velocity is as good a frame as the ground (Galileo), so here the tray stands
    still and the world moves: what differs from a resting belt is that the hand comes to a halt in the world
    while it lifts, which drags it across the tray.
    """

    def __init__(self, model: RobotModel, target: ObjectDescription, settings: RigSettings | None = None) -> None:
        self.model = model
        self.settings = settings or RigSettings()
        self._drive = GripperDrive(model.description.gripper)
        self._bullet = Bullet(self.settings.solver_iterations)
        self._floor = self._bullet.add_floor()
        size_m = tray_size_m(target, 0.0)
        self._tray_top_m = size_m[2]
        self._tray = self._bullet.add_box(size_m, Pose.of((0.0, 0.0, size_m[2] / 2)))
        self._object = self._bullet.add_object(target, Pose.of((0.0, 0.0, size_m[2] + 5e-4)))
        self._others = (self._object, self._tray, self._floor)
        self._middle = Pose.of((0.0, 0.0, target.height_m / 2))
        self._bullet.step(SETTLE_STEPS)
        self._at_rest = self._bullet.pose(self._object)
        self._bullet.set_pose(self._object, Pose.of((0.0, 0.0, 0.5)))
        self._hand = self._bullet.add_hand(model, Pose.of((0.0, 0.0, 1.0)))
        self._bullet.step()
        self._state = self._bullet.remember()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the world back."""
        self._bullet.close()

    def is_clear(self, T_object_grasp: Pose) -> bool:
        """Whether the open hand can go straight in without touching anything."""
        self._begin()
        s = self.settings
        return not any(
            self._near(self._on_the_way(self._in_world(T_object_grasp), back_m), s.clear_m, s.tray_clear_m)
            for back_m in self._stations()[::-1]
        )

    def attempt(
        self,
        T_object_grasp: Pose,
        T_believed_object: Pose | None = None,
        velocity_mps: Array | None = None,
    ) -> Attempted:
        """Go in, close, lift and hold, riding along with the belt.

        ``T_believed_object`` is where the object truly is, level, in the frame where it is believed to be;
        ``velocity_mps`` (2,) that of the belt in the believed object's frame.
        """
        self._begin()
        T_true = Pose.identity() if T_believed_object is None else T_believed_object.inverse()
        velocity = np.zeros(3)
        if velocity_mps is not None:
            velocity[:2] = velocity_mps
        grasp = self._in_world(T_true @ T_object_grasp)
        self._go_in(grasp)
        self._close_hand()
        if not self._is_gripped():
            return Attempted(False, "the fingers do not hold it")
        return self._lift(grasp, T_true.rotation @ velocity)

    def _begin(self) -> None:
        self._drive = GripperDrive(self.model.description.gripper)
        self._bullet.recall(self._state)
        self._hand.place(Pose.of((0.0, 0.0, 1.0)))
        self._hand.command_gripper(self._drive.target_rad)
        self._bullet.step()
        self._bullet.set_pose(self._object, self._at_rest)

    def _in_world(self, T_object_grasp: Pose) -> Pose:
        return Pose.of((0.0, 0.0, self._tray_top_m)) @ T_object_grasp

    def _stations(self) -> list[float]:
        """Distances back from the grasp, from the pregrasp on, at most ``STATION_M`` apart."""
        back_m = self.model.description.backoff_m
        return np.linspace(back_m, 0.0, int(np.ceil(back_m / STATION_M)) + 1).tolist()

    def _on_the_way(self, grasp: Pose, back_m: float) -> Pose:
        return grasp @ Pose.of((0.0, 0.0, -back_m))

    def _near(self, T_world_tcp: Pose, object_m: float, ground_m: float) -> bool:
        """Whether the open hand, put there, is nearer than that to the object, or to tray and floor."""
        hand, bullet = self._hand, self._bullet
        hand.place(T_world_tcp)
        if bullet.closest_distance_m(hand.body, self._object, object_m) is not None:
            return True
        return any(bullet.closest_distance_m(hand.body, b, ground_m) is not None for b in (self._tray, self._floor))

    def _go_in(self, grasp: Pose) -> None:
        """The approach; as long as nothing is within half the distance to the next station, nothing can touch."""
        stations = self._stations()
        reach_m = 0.5 * (stations[0] - stations[1]) + 5e-4
        clear = 0
        while clear < len(stations) and not self._near(self._on_the_way(grasp, stations[clear]), reach_m, reach_m):
            clear += 1
        start = max(clear - 1, 0)
        self._hand.place(self._on_the_way(grasp, stations[start]))
        self._drive_hand()
        if start == len(stations) - 1:
            return
        steps = round(self.settings.execution.approach_s / STEP_S)
        t_s = np.linspace(STEP_S, steps * STEP_S, steps)
        back_m = to_zero(np.array([stations[0]]), np.zeros(1), steps * STEP_S, t_s)[:, 0]
        self._move([self._on_the_way(grasp, b).xyz_m for b in back_m[back_m < stations[start]].tolist()])

    def _close_hand(self) -> None:
        self._drive.close()
        self._skip_empty_closing()
        closing = Closing(0.0, self.settings.execution.close_s, self._hand.finger_rad())
        step = 0
        while True:
            step += 1
            finger_rad = self._drive_hand()
            self._bullet.step()
            t_s = step * STEP_S
            if closing.over(t_s, STEP_S, finger_rad) or t_s >= self.settings.close_at_most_s:
                return

    def _skip_empty_closing(self) -> None:
        """Put the fingers to just before they meet anything: conservative advancement instead of physics steps."""
        gripper = self.model.description.gripper
        rad = gripper.open_rad
        while rad < gripper.closed_rad:
            gap_m = self._gap_m()
            if gap_m < SAFE_GAP_M:
                break
            rad = min(rad + (gap_m - 0.5 * SAFE_GAP_M) / FINGER_M, gripper.closed_rad)
            self._hand.place_fingers(rad, 0.0)
        if rad > gripper.open_rad:
            self._hand.place_fingers(rad, gripper.close_speed_rps)
            self._drive.go_on_from(rad)

    def _gap_m(self) -> float:
        """Between the hand and anything else, ``MOST_GAP_M`` at most."""
        gaps_m = [self._bullet.closest_distance_m(self._hand.body, body, MOST_GAP_M) for body in self._others]
        return min((gap_m for gap_m in gaps_m if gap_m is not None), default=MOST_GAP_M)

    def _lift(self, grasp: Pose, velocity: Array) -> Attempted:
        s = self.settings
        lift_m = s.execution.lift_m
        gripped, low_m = self._seen_from_tcp(), self._height_m()
        steps = round(s.lift_s / STEP_S)
        t_s = np.linspace(STEP_S, steps * STEP_S, steps)
        way = lift_way(t_s, velocity, s.lift_s, lift_m) - t_s[:, None] * velocity
        half = len(way) // 2
        places = grasp.xyz_m + way
        self._move(list(places[:half]))
        if self._height_m() - low_m < way[half - 1, 2] - s.short_m:
            return Attempted(False, "it does not come up")
        self._move(list(places[half:]))
        high_m = self._height_m()
        if high_m - low_m < lift_m - s.short_m:
            return Attempted(False, "it slips while it is lifted")
        rest = places[-1] - velocity * STEP_S * np.arange(1, round(s.hold_s / STEP_S) + 1)[:, None]
        self._move(list(rest))
        touching = {c.body_a if c.body_b == self._object else c.body_b for c in self._bullet.contacts(self._object)}
        if high_m - self._height_m() > s.fell_m or touching != {self._hand.body}:
            return Attempted(False, "it slips while it is held")
        return Attempted(True, slip_m=float(np.linalg.norm(self._seen_from_tcp() - gripped)))

    def _move(self, tcps_m: list[Array]) -> None:
        """One physics step per place of the tcp; the hand does not turn."""
        for tcp_m in tcps_m:
            self._hand.shift_to(tcp_m)
            self._drive_hand()
            self._bullet.step()

    def _drive_hand(self) -> float:
        """Command the fingers; the master joint's position."""
        return self._hand.command_gripper(self._drive.update(STEP_S))

    def _height_m(self) -> float:
        return float(self._bullet.pose(self._object).xyz_m[2])

    def _seen_from_tcp(self) -> Array:
        return (self._hand.tcp().inverse() @ self._bullet.pose(self._object) @ self._middle).xyz_m

    def _is_gripped(self) -> bool:
        hand = self._hand.body
        touching = {c.link_a if c.body_a == hand else c.link_b for c in self._bullet.contacts(self._object, hand)}
        return len(touching & set(self.model.description.gripper.finger_links)) >= 2
