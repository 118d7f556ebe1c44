"""The hand in the simulated world: its fingers, and the hand without an arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from backend.pose import Array, Pose
from backend.robots.models import RobotModel

if TYPE_CHECKING:
    from backend.sim.bullet import Bullet

PAD_FRICTION = 1.0
"""Rubber pads; a contact has the product of this and the object's."""
HAND_FORCE_N = 5e3
FOLLOWER_GAIN = 0.1
"""Position gain of the joints that go where the master is."""


class Hand:
    """What the arm with its hand and the hand alone have in common: links, joints, fingers."""

    def __init__(self, bullet: Bullet, body: int, model: RobotModel) -> None:
        self.body = body
        self.model = model
        self._bullet = bullet
        self._gripper = gripper = model.description.gripper
        self._joints = bullet.joints(body)
        self._movable = list(self._joints.values())
        self._master = self._joints[gripper.master_joint]
        self._gears: list[int] = []
        for coupled in (*gripper.gears, *gripper.followers):
            bullet.release(body, self._joints[coupled.joint])
        for link in gripper.finger_links:
            bullet.set_friction(body, link, PAD_FRICTION)
        for follower in gripper.followers:
            if follower.multiplier != 0.0:
                bullet.make_intangible(body, self._joints[follower.joint])

    def joints_rad(self) -> dict[str, float]:
        """Every movable joint by name."""
        states = self._bullet.joint_states(self.body, self._movable)
        return {name: float(state[0]) for name, state in zip(self._joints, states, strict=True)}

    def link_pose(self, link: str) -> Pose:
        """T_world_link; raises ``NotFoundError`` for an unknown link."""
        return self._bullet.link_pose(self.body, link)

    def finger_rad(self) -> float:
        """Where the master joint is."""
        return float(self._bullet.joint_states(self.body, [self._master])[0][0])

    def command_gripper(self, rad: float) -> float:
        """Target of the master joint for the coming steps; followers go where the master is, which is returned."""
        gripper, bullet = self._gripper, self._bullet
        bullet.drive(self.body, self._master, rad, gripper.max_force, gripper.position_gain)
        at_rad = self.finger_rad()
        for follower in gripper.followers:
            joint = self._joints[follower.joint]
            bullet.drive(self.body, joint, follower.multiplier * at_rad, follower.max_force, FOLLOWER_GAIN)
        return at_rad

    def place_fingers(self, rad: float, rate_rps: float) -> None:
        """Put the master at ``rad``, moving at ``rate_rps``, and the coupled joints where they belong."""
        self._bullet.reset_joint(self.body, self._master, rad, rate_rps)
        for coupled in (*self._gripper.gears, *self._gripper.followers):
            q, rate = coupled.multiplier * rad, coupled.multiplier * rate_rps
            self._bullet.reset_joint(self.body, self._joints[coupled.joint], q, rate)

    def reset_fingers(self, rad: float) -> None:
        """Put the fingers at ``rad`` and couple them anew: gears remember where they were made."""
        bullet, gripper = self._bullet, self._gripper
        for gear in self._gears:
            bullet.remove_constraint(gear)
        self.place_fingers(rad, 0.0)
        self._gears = [
            bullet.gear(self.body, self._master, self._joints[g.joint], g.multiplier, g.max_force, g.erp)
            for g in gripper.gears
        ]
        self.command_gripper(rad)


class HandAlone(Hand):
    """The hand on a free base that a moved constraint holds: for lifts without an arm."""

    def __init__(self, bullet: Bullet, body: int, model: RobotModel, T_world_tcp: Pose) -> None:
        super().__init__(bullet, body, model)
        self._T_tcp_root = model.T_handroot_tcp.inverse()
        self._tie = bullet.tie_to_world(body, T_world_tcp @ self._T_tcp_root, HAND_FORCE_N)
        self.reset(T_world_tcp, model.description.gripper.open_rad)

    def move_to(self, T_world_tcp: Pose) -> None:
        """Let the tcp be at ``T_world_tcp`` after the next step."""
        self._bullet.move_tie(self._tie, T_world_tcp @ self._T_tcp_root)

    def shift_to(self, tcp_m: Array) -> None:
        """Let the tcp be at ``tcp_m`` (3,) after the next step, turned as it was placed."""
        self._bullet.shift_tie(self._tie, tcp_m + self._root_from_tcp_m)

    def place(self, T_world_tcp: Pose) -> None:
        """Be at rest at ``T_world_tcp``, the fingers as they are."""
        T_world_root = T_world_tcp @ self._T_tcp_root
        self._root_from_tcp_m = T_world_root.xyz_m - T_world_tcp.xyz_m
        self._bullet.set_pose(self.body, T_world_root)
        self._bullet.move_tie(self._tie, T_world_root)

    def reset(self, T_world_tcp: Pose, gripper_rad: float) -> None:
        """Be at rest at ``T_world_tcp`` with the fingers at ``gripper_rad``."""
        self.place(T_world_tcp)
        self.reset_fingers(gripper_rad)

    def tcp(self) -> Pose:
        """T_world_tcp."""
        return self._bullet.pose(self.body) @ self.model.T_handroot_tcp
