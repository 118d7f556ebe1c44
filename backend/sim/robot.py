"""The arm with its hand in the simulated world."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from backend.pose import Array, Pose
from backend.robots.models import RobotModel
from backend.sim.hand import FOLLOWER_GAIN, Hand

if TYPE_CHECKING:
    from backend.sim.bullet import Bullet

POSITION_GAIN = 0.3


class Robot(Hand):
    """The arm with its hand inside one ``Bullet``."""

    def __init__(self, bullet: Bullet, body: int, model: RobotModel) -> None:
        super().__init__(bullet, body, model)
        gripper, followers = self._gripper, self._gripper.followers
        self._arm = [self._joints[name] for name in model.description.arm_joints]
        self._driven = [*self._arm, self._master, *(self._joints[follower.joint] for follower in followers)]
        self._forces = [*model.description.joint_effort_nm, gripper.max_force, *(f.max_force for f in followers)]
        self._gains = [POSITION_GAIN] * len(self._arm) + [gripper.position_gain] + [FOLLOWER_GAIN] * len(followers)
        self._hand_still = [0.0] * (1 + len(followers))

    def q(self) -> Array:
        """(dof,) rad."""
        return np.array([state[0] for state in self._states()])

    def qd(self) -> Array:
        """(dof,) rad/s."""
        return np.array([state[1] for state in self._states()])

    def command(self, q: Sequence[float], qd: Sequence[float], gripper_rad: float) -> None:
        """Follow a reference that is at ``q`` (dof,) rad now and moves at ``qd`` (dof,) rad/s; fingers to an angle."""
        at_rad = self.finger_rad()
        following = [follower.multiplier * at_rad for follower in self._gripper.followers]
        wanted = [*q, gripper_rad, *following]
        self._bullet.drive_all(self.body, self._driven, wanted, [*qd, *self._hand_still], self._forces, self._gains)

    def reset(self, q: Array, gripper_rad: float) -> None:
        """Be at rest at ``q`` (dof,) rad with the fingers at ``gripper_rad``, and stay there."""
        for joint, rad in zip(self._arm, q, strict=True):
            self._bullet.reset_joint(self.body, joint, float(rad))
        self.reset_fingers(gripper_rad)
        self.command(q.tolist(), [0.0] * len(self._arm), gripper_rad)

    def tcp(self) -> Pose:
        """T_world_tcp."""
        description = self.model.description
        return self.link_pose(description.flange_link) @ description.T_flange_tcp

    def self_contacts(self, within_m: float = 0.0) -> set[frozenset[str]]:
        """Pairs of links nearer than ``within_m`` that should not be; slow: to check poses, not for control.

        Not counted: links that one arm joint at most lies between, and the allowed pairs of the description.
        """
        found: set[frozenset[str]] = set()
        for a, b in self._checked_pairs():
            distance_m = self._bullet.link_distance_m(self.body, a, b, within_m)
            if distance_m is not None and distance_m < within_m:
                found.add(frozenset((a, b)))
        return found

    def _checked_pairs(self) -> list[tuple[str, str]]:
        robot = self.model.description
        hand = len(self._arm)
        carriers = {
            link: hand if link in robot.gripper.hand_links else self._arm_joints_above(link)
            for link in self.model.spheres
        }
        return [
            (a, b)
            for a, b in combinations(self.model.spheres, 2)
            if abs(carriers[a] - carriers[b]) > 1 and frozenset((a, b)) not in robot.allowed_self_contacts
        ]

    def _arm_joints_above(self, link: str) -> int:
        index = self._bullet.link_index(self.body, link)
        return sum(joint <= index for joint in self._arm)

    def _states(self) -> Sequence[Sequence[float]]:
        return self._bullet.joint_states(self.body, self._arm)
