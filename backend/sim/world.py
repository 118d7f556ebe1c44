"""World: what is really happening, in one PyBullet client that lives as long as the episode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np

from backend.errors import InvalidInputError, SimulationError
from backend.events import AddObstacle, MoveObstacle, RemoveObstacle, SetBeltRate, SetSlab, WorldEvent
from backend.objects import load_object
from backend.pose import Array, Pose
from backend.robots.models import RobotModel
from backend.sim.bullet import SOLVER_ITERATIONS, STEP_S, Bullet, GripperDrive
from backend.sim.conveyor import Conveyor
from backend.snapshot import BoxPlacement
from backend.tasks.setup import TrialSetup
from backend.tasks.slab import slab_above

TRAY_MASS_KG = 1000.0
"""So heavy that its load does not move it."""
SETTLE_S = 2.0
LEAST_SETTLING = 48
LOOK_EVERY = 12
REST_SPEED_MPS = 1e-4
"""Settling ends when nothing is faster, metres or radians per second, at one of every 12 steps after the 48th."""
NO_SPIN = np.zeros(3)
FREE_ITERATIONS = 30
"""Of the solver while the hand is away from the object: arm and load go the same way to 0.4 mrad and 0.02 mm."""


def upright(event: MoveObstacle | AddObstacle) -> Pose:
    """T_world_obstacle that an edit asks for."""
    return Pose.from_xyz_yaw((event.x_m, event.y_m, 0.0), event.yaw_rad)


class World:
    """Arm, hand, tray, object, obstacles and slab; stepped at 240 Hz and the same bit for bit every time."""

    def __init__(self, model: RobotModel, object_name: str, setup: TrialSetup) -> None:
        self.model = model
        self.object = load_object(object_name)
        self.setup = setup
        self.conveyor = Conveyor(setup.motion)
        self.steps = 0
        self._seen = (-1, Pose.identity())
        """The step at which the object was last looked at, and where it was: senses, judge and record all ask."""
        self._handling = False
        self._bullet = Bullet(FREE_ITERATIONS)
        self._floor = self._bullet.add_floor()
        home = np.array(model.description.home_rad)
        self._robot = self._bullet.add_robot(model, home, model.description.gripper.open_rad)
        self.gripper = GripperDrive(model.description.gripper)
        self._tray_half_m = setup.tray_size_m[2] / 2
        T_tray_center = Pose.of((0.0, 0.0, -self._tray_half_m))
        self._T_center_tray = T_tray_center.inverse()
        T_world_tray = self.conveyor.pose
        self._tray_wxyz: list[float] = T_world_tray.wxyz.tolist()
        self._tray = self._bullet.add_box(setup.tray_size_m, T_world_tray @ T_tray_center, mass_kg=TRAY_MASS_KG)
        self._bullet.ignore_contacts(self._tray, "", self._robot.body, "")
        self._bullet.ignore_contacts(self._tray, "", self._floor, "")
        T_tray_object = Pose.from_xyz_yaw((0.0, 0.0, 0.0), setup.object_yaw_rad)
        self._target = self._bullet.add_object(self.object, T_world_tray @ T_tray_object)
        self.obstacles = tuple(name for name, _ in setup.obstacles)
        """What stands around now."""
        self._obstacles = [self._bullet.add_object(load_object(n), pose) for n, pose in setup.obstacles]
        self.slab: BoxPlacement | None = None
        self._slab: int | None = None
        self._hang(setup.slab)
        self._settle(home)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the client back; the world can't be used afterwards."""
        self._bullet.close()

    @property
    def t_s(self) -> float:
        """Simulated time since the belt started."""
        return self.steps * STEP_S

    def handle(self, handling: bool) -> None:
        """Say whether the hand is at the object or on its way in: only then are contacts solved as long as it takes."""
        if handling != self._handling:
            self._handling = handling
            self._bullet.set_solver_iterations(SOLVER_ITERATIONS if handling else FREE_ITERATIONS)

    def step(self, q: Sequence[float], qd: Sequence[float]) -> None:
        """One physics step towards joint positions ``q`` (dof,) rad moving at ``qd`` (dof,) rad/s."""
        x, y, z = self.conveyor.xyz_m
        self.conveyor.advance(STEP_S)
        to_x, to_y, to_z = self.conveyor.xyz_m
        self._carry(x, y, z, ((to_x - x) / STEP_S, (to_y - y) / STEP_S, (to_z - z) / STEP_S))
        self._robot.command(q, qd, self.gripper.update(STEP_S))
        self._bullet.step()
        self.steps += 1

    def step_bare(self, q: Sequence[float], qd: Sequence[float], count: int) -> None:
        """Nothing but physics: hold the arm at ``q`` and step, for comparison with whole trials."""
        self._robot.command(q, qd, self.gripper.target_rad)
        self._bullet.step(count)
        self.steps += count

    def apply(self, event: WorldEvent) -> None:
        """Carry out a live edit; raises ``InvalidInputError`` for an obstacle that does not exist."""
        match event:
            case SetBeltRate():
                self.conveyor.request_rate(event.rate)
            case MoveObstacle():
                body = self._obstacles[self.obstacle(event.index)]
                self._bullet.set_pose(body, upright(event))
                self._bullet.set_velocity(body, NO_SPIN, NO_SPIN)
            case AddObstacle():
                self._obstacles.append(self._bullet.add_object(load_object(event.object), upright(event)))
                self.obstacles = (*self.obstacles, event.object)
            case RemoveObstacle():
                index = self.obstacle(event.index)
                self._bullet.remove_body(self._obstacles.pop(index))
                self.obstacles = (*self.obstacles[:index], *self.obstacles[index + 1 :])
            case SetSlab():
                height_m = event.height_m
                self._hang(None if height_m is None else slab_above(self.setup.motion, height_m))

    def q(self) -> Array:
        """(dof,) rad."""
        return self._robot.q()

    def qd(self) -> Array:
        """(dof,) rad/s."""
        return self._robot.qd()

    def finger_rad(self) -> float:
        """Angle of the hand's master joint."""
        return self._robot.finger_rad()

    def joints_rad(self) -> dict[str, float]:
        """Every movable joint of arm and hand."""
        return self._robot.joints_rad()

    def object_pose(self) -> Pose:
        """T_world_object; raises ``SimulationError`` when the physics has diverged."""
        step, pose = self._seen
        if step == self.steps:
            return pose
        try:
            pose = self._bullet.pose(self._target)
        except ValueError as error:
            raise SimulationError(f"The simulation diverged at {self.t_s:.3f} s: {error}") from error
        self._seen = self.steps, pose
        return pose

    def object_velocity(self) -> tuple[Array, Array]:
        """Linear (3,) m/s and angular (3,) rad/s."""
        return self._bullet.velocity(self._target)

    def tray_pose(self) -> Pose:
        """T_world_tray, middle of the top face, as the physics has it."""
        return self._bullet.pose(self._tray) @ self._T_center_tray

    def tray_velocity(self) -> Array:
        """(3,) m/s as the physics has it."""
        return self._bullet.velocity(self._tray)[0]

    def obstacle_poses(self) -> list[Pose]:
        """T_world_obstacle of each."""
        return [self._bullet.pose(body) for body in self._obstacles]

    def touching_object(self) -> tuple[set[str], bool]:
        """Names of the robot's links in contact with the object, and whether anything else touches it.

        Surfaces that press on each other touch, though the solver may hold them tenths of a millimetre apart.
        """
        links: set[str] = set()
        others = False
        for contact in self._bullet.contacts(self._target):
            if contact.distance_m > 0.0 and contact.normal_force_n <= 0.0:
                continue
            other, link = (
                (contact.body_b, contact.link_b) if contact.body_a == self._target else (contact.body_a, contact.link_a)
            )
            if other == self._robot.body:
                links.add(link)
            else:
                others = True
        return links, others

    def grip_n(self) -> float:
        """Sum of the normal forces between the robot's links and the object in the last step, N."""
        return sum(contact.normal_force_n for contact in self._bullet.contacts(self._target, self._robot.body))

    def obstacle(self, index: int) -> int:
        """The index itself; raises ``InvalidInputError`` when there is no such obstacle."""
        if index >= len(self._obstacles):
            raise InvalidInputError(f"There is no obstacle {index}; this scene has {len(self._obstacles)}.")
        return index

    def _hang(self, slab: BoxPlacement | None) -> None:
        """This slab instead of the one there was, or none."""
        if self._slab is not None:
            self._bullet.remove_body(self._slab)
        self.slab = slab
        self._slab = None if slab is None else self._bullet.add_box(slab.size_m, slab.T_world_box)

    def _carry(self, x_m: float, y_m: float, z_m: float, velocity_mps: Sequence[float]) -> None:
        """Drive the tray, its top's middle there, through the coming step; it never turns."""
        self._bullet.carry(self._tray, (x_m, y_m, z_m - self._tray_half_m), self._tray_wxyz, velocity_mps)

    def _settle(self, home: Array) -> None:
        """Let everything come to rest on the standing belt, then set the belt and its load in motion."""
        at_m, hold, still = self.conveyor.xyz_m, home.tolist(), [0.0] * len(home)
        bodies = [self._target, *self._obstacles]
        for k in range(int(SETTLE_S / STEP_S)):
            self._carry(*at_m, NO_SPIN.tolist())
            self._robot.command(hold, still, self.gripper.update(STEP_S))
            self._bullet.step()
            if k % LOOK_EVERY == 0 and k > LEAST_SETTLING:
                speeds = [np.abs(np.concatenate(self._bullet.velocity(body))).max() for body in bodies]
                if max(speeds) < REST_SPEED_MPS:
                    break
        self._bullet.set_velocity(self._target, self.conveyor.velocity_mps(), NO_SPIN)
