"""A simulated lift of the hand alone: does this grasp hold this object?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose
from backend.robots.models import RobotModel
from backend.sim.bullet import STEP_S, Bullet, GripperDrive, HandAlone
from backend.tasks.setup import tray_size_m


@dataclass(frozen=True)
class LiftSettings:
    """One lift: go in, close, lift, hold."""

    approach_s: float = 0.5
    close_s: float = 0.7
    lift_s: float = 0.7
    lift_m: float = 0.12
    hold_s: float = 0.4
    noise_xy_m: float = 0.01
    noise_yaw_rad: float = float(np.radians(20.0))
    solver_iterations: int = 60
    clearance_m: float = 0.002
    """Least distance of the open hand to the object on the way in."""
    tray_clearance_m: float = 0.004
    """Least distance of the open hand to tray and floor on the way in."""


@dataclass(frozen=True)
class Lifted:
    """How a lift ended."""

    held: bool
    slip_m: float = float("inf")
    """How far the object's middle moved in the hand from the end of the closing to the end of the hold."""


class Bench:
    """The object on its tray in its own world; a hand tries its grasps one by one."""

    def __init__(self, model: RobotModel, target: ObjectDescription, settings: LiftSettings) -> None:
        self.model = model
        self.settings = settings
        self._target = target
        self._tray_m = tray_size_m(target, 0.0)

    def is_clear(self, Ts_object_grasp: Array) -> list[bool]:
        """Of each grasp (n, 4, 4): whether the open hand can go straight in without touching anything."""
        with self._world() as bullet:
            tray, target = self._furnish(bullet, Pose.identity())
            hand = bullet.add_hand(self.model, Pose.of((0.0, 0.0, 1.0)))
            return [self._way_is_clear(bullet, hand, tray, target, Pose(T)) for T in Ts_object_grasp]

    def lift(self, T_object_grasp: Pose, rng: np.random.Generator | None) -> Lifted:
        """Whether the hand brings the object up; with ``rng`` the object is not just where believed."""
        s = self.settings
        with self._world() as bullet:
            T_believed = Pose.of((0.0, 0.0, self._tray_m[2]))
            _, target = self._furnish(bullet, self._misplacement(rng))
            grasp = T_believed @ T_object_grasp
            back = self.model.description.backoff_m
            hand = bullet.add_hand(self.model, grasp @ Pose.of((0.0, 0.0, -back)))
            drive = GripperDrive(self.model.description.gripper)
            for u in _ramp(s.approach_s):
                _advance(bullet, hand, drive, grasp @ Pose.of((0.0, 0.0, (u - 1.0) * back)))
            drive.close()
            for _ in _ramp(s.close_s):
                _advance(bullet, hand, drive, grasp)
            if not self._is_gripped(bullet, hand, target):
                return Lifted(False)
            gripped = self._seen_from_tcp(bullet, hand, target)
            for u in _ramp(s.lift_s):
                _advance(bullet, hand, drive, Pose.of((0.0, 0.0, u * u * (3.0 - 2.0 * u) * s.lift_m)) @ grasp)
            before_m = bullet.pose(target).xyz_m[2]
            if before_m - self._tray_m[2] < s.lift_m - 0.04:
                return Lifted(False)
            for _ in _ramp(s.hold_s):
                _advance(bullet, hand, drive, Pose.of((0.0, 0.0, s.lift_m)) @ grasp)
            fell_m = before_m - bullet.pose(target).xyz_m[2]
            touched = {c.body_a if c.body_b == target else c.body_b for c in bullet.contacts(target)}
            slip_m = float(np.linalg.norm(self._seen_from_tcp(bullet, hand, target) - gripped))
            return Lifted(fell_m < 0.005 and touched == {hand.body}, slip_m)

    def _world(self) -> Bullet:
        return Bullet(self.settings.solver_iterations)

    def _furnish(self, bullet: Bullet, T_believed_object: Pose) -> tuple[int, int]:
        bullet.add_floor()
        tray = bullet.add_box(self._tray_m, Pose.of((0.0, 0.0, self._tray_m[2] / 2)))
        T_world_object = Pose.of((0.0, 0.0, self._tray_m[2] + 1e-3)) @ T_believed_object
        return tray, bullet.add_object(self._target, T_world_object)

    def _misplacement(self, rng: np.random.Generator | None) -> Pose:
        if rng is None:
            return Pose.identity()
        s = self.settings
        x, y = rng.uniform(-s.noise_xy_m, s.noise_xy_m, 2)
        return Pose.from_xyz_yaw((x, y, 0.0), rng.uniform(-s.noise_yaw_rad, s.noise_yaw_rad))

    def _way_is_clear(self, bullet: Bullet, hand: HandAlone, tray: int, target: int, T_object_grasp: Pose) -> bool:
        s = self.settings
        grasp = Pose.of((0.0, 0.0, self._tray_m[2])) @ T_object_grasp
        back = self.model.description.backoff_m
        for share in (0.0, 1.0, 0.5, 0.25, 0.75):
            hand.reset(grasp @ Pose.of((0.0, 0.0, -share * back)), self.model.description.gripper.open_rad)
            near = bullet.closest_distance_m(hand.body, target, s.clearance_m)
            grounds = (bullet.closest_distance_m(hand.body, b, s.tray_clearance_m) for b in (tray, 0))
            if near is not None or any(ground is not None for ground in grounds):
                return False
        return True

    def _seen_from_tcp(self, bullet: Bullet, hand: HandAlone, target: int) -> Array:
        middle = bullet.pose(target) @ Pose.of((0.0, 0.0, self._target.height_m / 2))
        return (hand.tcp().inverse() @ middle).xyz_m

    def _is_gripped(self, bullet: Bullet, hand: HandAlone, target: int) -> bool:
        touching = {c.link_a if c.body_a == hand.body else c.link_b for c in bullet.contacts(hand.body, target)}
        return len(touching & set(self.model.description.gripper.finger_links)) >= 2


def _ramp(duration_s: float) -> list[float]:
    """Shares of the way done after each physics step; the last is 1."""
    steps = round(duration_s / STEP_S)
    return [(k + 1) / steps for k in range(steps)]


def _advance(bullet: Bullet, hand: HandAlone, drive: GripperDrive, T_world_tcp: Pose) -> None:
    hand.move_to(T_world_tcp)
    hand.command_gripper(drive.update(STEP_S))
    bullet.step()
