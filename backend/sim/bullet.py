"""PyBullet's door: the only file that imports it. Frames are link frames, quaternions outside are wxyz."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self, cast

import numpy as np
import pybullet

from backend.errors import NotFoundError, SimulationError, not_found_text
from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose
from backend.robots.description import GripperDescription
from backend.robots.models import RobotModel
from backend.sim.gripper import GripperDrive
from backend.sim.object_files import object_mesh_file

__all__ = ["STEP_S", "Bullet", "Contact", "GripperDrive", "HandAlone", "Robot"]

STEP_S = 1 / 240
SOLVER_ITERATIONS = 100
GRAVITY_MPS2 = 9.81
FLOOR_FRICTION = 1.0
PAD_FRICTION = 1.0
"""Rubber pads; PyBullet multiplies it with the object's."""
SPINNING_FRICTION = 0.002
TIE_ERP = 0.8
HAND_FORCE_N = 5e3
_p = cast(Any, pybullet)
_Frame = tuple[Sequence[float], Sequence[float]]
"""PyBullet's (xyz, xyzw)."""


@dataclass(frozen=True)
class Contact:
    """Two links that touch, or nearly so."""

    body_a: int
    link_a: str
    """"" for the base of a plain body."""
    body_b: int
    link_b: str
    distance_m: float
    """Negative when they penetrate."""
    normal_force_n: float


class Bullet:
    """One DIRECT client, always addressed by its id. Same calls, same numbers, bit for bit."""

    def __init__(self, solver_iterations: int = SOLVER_ITERATIONS) -> None:
        self._id: int = _p.connect(_p.DIRECT)
        self._links: dict[int, dict[str, int]] = {}
        self._names: dict[int, dict[int, str]] = {}
        self._T_base_inertial: dict[int, Pose] = {}
        self._T_inertial_base: dict[int, Pose] = {}
        _p.setGravity(0.0, 0.0, -GRAVITY_MPS2, physicsClientId=self._id)
        _p.setPhysicsEngineParameter(
            fixedTimeStep=STEP_S,
            numSolverIterations=solver_iterations,
            erp=TIE_ERP,
            deterministicOverlappingPairs=1,
            physicsClientId=self._id,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def id(self) -> int:
        """PyBullet's client id; raises ``SimulationError`` after ``close``."""
        if self._id < 0:
            raise SimulationError("This simulated world is closed.")
        return self._id

    def close(self) -> None:
        """Give the client back. A second call does nothing."""
        if self._id >= 0:
            _p.disconnect(physicsClientId=self._id)
            self._id = -1

    def step(self, count: int = 1) -> None:
        """``count`` physics steps of ``STEP_S``."""
        client = self.id
        for _ in range(count):
            _p.stepSimulation(physicsClientId=client)

    def add_floor(self) -> int:
        """An endless floor at z = 0."""
        shape = _p.createCollisionShape(_p.GEOM_PLANE, physicsClientId=self.id)
        body = _p.createMultiBody(0.0, shape, physicsClientId=self.id)
        return self._register(body, Pose.identity(), FLOOR_FRICTION)

    def add_object(self, description: ObjectDescription, T_world_object: Pose, *, fixed: bool = False) -> int:
        """A rigid body made of the description's convex parts, with its true mass and inertia."""
        path = object_mesh_file(description)
        shape = _p.createCollisionShape(_p.GEOM_MESH, fileName=str(path), physicsClientId=self.id)
        moments, axes = np.linalg.eigh(description.inertia_kgm2)
        axes[:, 2] *= np.sign(np.linalg.det(axes))
        T_object_inertial = np.eye(4)
        T_object_inertial[:3, :3], T_object_inertial[:3, 3] = axes, description.center_of_mass_m
        body = self._add_body(0.0 if fixed else description.mass_kg, shape, Pose(T_object_inertial), moments)
        self._register(
            body, Pose(T_object_inertial), description.lateral_friction, description.spinning_friction
        )
        self.set_pose(body, T_world_object)
        return body

    def add_box(
        self, size_m: Sequence[float], T_world_box: Pose, *, mass_kg: float = 0.0, friction: float = 1.0
    ) -> int:
        """A box of uniform density, fixed when it has no mass."""
        shape = _p.createCollisionShape(
            _p.GEOM_BOX, halfExtents=[s / 2 for s in size_m], physicsClientId=self.id
        )
        moments = mass_kg / 12.0 * (float(np.dot(size_m, size_m)) - np.square(size_m))
        body = self._add_body(mass_kg, shape, Pose.identity(), moments)
        self._register(body, Pose.identity(), friction)
        self.set_pose(body, T_world_box)
        return body

    def add_robot(self, model: RobotModel, q: Array, gripper_rad: float) -> Robot:
        """The arm with its hand, base on the world frame, at joint positions ``q`` (dof,) rad."""
        body = self._load(model.collision_urdf, fixed=True)
        robot = Robot(self, body, model)
        robot.reset(q, gripper_rad)
        return robot

    def add_hand(self, model: RobotModel, T_world_tcp: Pose) -> HandAlone:
        """The hand without its arm, open, held in the air at ``T_world_tcp``."""
        return HandAlone(self, self._load(model.hand_urdf, fixed=False), model, T_world_tcp)

    def pose(self, body: int) -> Pose:
        """T_world_body."""
        frame = _p.getBasePositionAndOrientation(body, physicsClientId=self.id)
        return _pose(frame) @ self._T_inertial_base[body]

    def set_pose(self, body: int, T_world_body: Pose) -> None:
        """Put a body elsewhere; its velocity becomes zero."""
        frame = _frame(T_world_body @ self._T_base_inertial[body])
        _p.resetBasePositionAndOrientation(body, *frame, physicsClientId=self.id)

    def velocity(self, body: int) -> tuple[Array, Array]:
        """Linear (3,) m/s of the body frame's origin, and angular (3,) rad/s, in the world frame."""
        linear, angular = _p.getBaseVelocity(body, physicsClientId=self.id)
        linear, angular = np.array(linear), np.array(angular)
        return linear - np.cross(angular, self._lever(body)), angular

    def set_velocity(self, body: int, linear: Array, angular: Array) -> None:
        """The counterpart of ``velocity``."""
        at_mass = linear + np.cross(angular, self._lever(body))
        _p.resetBaseVelocity(body, at_mass.tolist(), np.asarray(angular).tolist(), physicsClientId=self.id)

    def tie_to_world(self, body: int, T_world_body: Pose, max_force: float) -> int:
        """Hold a free body at a pose by a constraint of at most ``max_force`` (N); returns the constraint."""
        xyz, xyzw = _frame(self._T_inertial_base[body])
        tie: int = _p.createConstraint(
            body, -1, -1, -1, _p.JOINT_FIXED, [0, 0, 0], xyz, [0, 0, 0], xyzw, physicsClientId=self.id
        )
        _p.changeConstraint(tie, maxForce=max_force, physicsClientId=self.id)
        self.move_tie(tie, T_world_body)
        return tie

    def move_tie(self, constraint: int, T_world_body: Pose) -> None:
        """Let the tied body be at ``T_world_body`` after the next step."""
        xyz, xyzw = _frame(T_world_body)
        _p.changeConstraint(
            constraint, jointChildPivot=xyz, jointChildFrameOrientation=xyzw, physicsClientId=self.id
        )

    def carry(self, body: int, xyz_m: Array, wxyz: Array, velocity_mps: Array) -> None:
        """Drive a free, heavy, symmetric body through the coming step: from a position, at a velocity.

        Bullet's kinematic bodies stand still for friction, and a tie lags behind and jerks at the start; a body
        that is put on its way before every step, against the gravity of that step, carries its load without slip.
        """
        w, x, y, z = wxyz.tolist()
        vx, vy, vz = velocity_mps.tolist()
        _p.resetBasePositionAndOrientation(body, xyz_m.tolist(), (x, y, z, w), physicsClientId=self._id)
        against = vz + GRAVITY_MPS2 * STEP_S
        _p.resetBaseVelocity(body, (vx, vy, against), (0.0, 0.0, 0.0), physicsClientId=self._id)

    def contacts(self, body_a: int, body_b: int | None = None) -> list[Contact]:
        """Contact points of the last step, of one body with any other, or of two."""
        others = {} if body_b is None else {"bodyB": body_b}
        return [self._contact(c) for c in _p.getContactPoints(body_a, **others, physicsClientId=self.id)]

    def closest_distance_m(self, body_a: int, body_b: int, within_m: float) -> float | None:
        """Least distance of two bodies, negative when they overlap; None when it is above ``within_m``."""
        points = _p.getClosestPoints(body_a, body_b, within_m, physicsClientId=self.id)
        return min((float(point[8]) for point in points), default=None)

    def link_distance_m(self, body: int, link_a: str, link_b: str, within_m: float) -> float | None:
        """The same for two links of one body."""
        a, b = self.link_index(body, link_a), self.link_index(body, link_b)
        points = _p.getClosestPoints(
            body, body, within_m, linkIndexA=a, linkIndexB=b, physicsClientId=self.id
        )
        return min((float(point[8]) for point in points), default=None)

    def ignore_contacts(self, body_a: int, link_a: str, body_b: int, link_b: str) -> None:
        """Let two links pass through each other; ``""`` is a body's base."""
        a, b = self.link_index(body_a, link_a), self.link_index(body_b, link_b)
        _p.setCollisionFilterPair(body_a, body_b, a, b, 0, physicsClientId=self.id)

    def link_index(self, body: int, link: str) -> int:
        """PyBullet's number of a link; raises ``NotFoundError``."""
        links = self._links[body]
        if link not in links:
            raise NotFoundError(not_found_text("link", link, links))
        return links[link]

    def _add_body(self, mass_kg: float, shape: int, T_body_inertial: Pose, moments: Array) -> int:
        xyz, xyzw = _frame(T_body_inertial)
        body: int = _p.createMultiBody(
            mass_kg,
            shape,
            baseInertialFramePosition=xyz,
            baseInertialFrameOrientation=xyzw,
            physicsClientId=self.id,
        )
        if mass_kg > 0.0:
            _p.changeDynamics(body, -1, localInertiaDiagonal=moments.tolist(), physicsClientId=self.id)
        return body

    def _load(self, urdf: Path, *, fixed: bool) -> int:
        body: int = _p.loadURDF(
            str(urdf), useFixedBase=fixed, flags=_p.URDF_USE_INERTIA_FROM_FILE, physicsClientId=self.id
        )
        dynamics = _p.getDynamicsInfo(body, -1, physicsClientId=self.id)
        return self._register(body, _pose((dynamics[3], dynamics[4])), 0.5)

    def _register(
        self, body: int, T_base_inertial: Pose, friction: float, spinning: float = SPINNING_FRICTION
    ) -> int:
        """Note the body's frames and link names; no damping anywhere."""
        self._T_base_inertial[body] = T_base_inertial
        self._T_inertial_base[body] = T_base_inertial.inverse()
        links = {"": -1}
        count: int = _p.getNumJoints(body, physicsClientId=self.id)
        if count:
            links[_p.getBodyInfo(body, physicsClientId=self.id)[0].decode()] = -1
        for i in range(count):
            links[_p.getJointInfo(body, i, physicsClientId=self.id)[12].decode()] = i
        self._links[body] = links
        self._names[body] = {index: name for name, index in links.items()}
        for i in range(-1, count):
            _p.changeDynamics(
                body,
                i,
                lateralFriction=friction,
                spinningFriction=spinning,
                linearDamping=0.0,
                angularDamping=0.0,
                jointDamping=0.0,
                physicsClientId=self.id,
            )
        return body

    def _lever(self, body: int) -> Array:
        """(3,) from the body frame's origin to the centre of mass, in the world frame."""
        return self.pose(body).rotation @ self._T_base_inertial[body].xyz_m

    def _contact(self, point: Sequence[Any]) -> Contact:
        a, b = int(point[1]), int(point[2])
        names_a, names_b = self._names[a], self._names[b]
        return Contact(a, names_a[point[3]], b, names_b[point[4]], float(point[8]), float(point[9]))


class _Hand:
    """What the arm with its hand and the hand alone have in common: the fingers."""

    def __init__(self, bullet: Bullet, body: int, gripper: GripperDescription) -> None:
        self.body = body
        self._bullet = bullet
        self._gripper = gripper
        client = bullet.id
        infos = [
            _p.getJointInfo(body, i, physicsClientId=client)
            for i in range(_p.getNumJoints(body, physicsClientId=client))
        ]
        self._joints: dict[str, int] = {i[1].decode(): i[0] for i in infos if i[2] != _p.JOINT_FIXED}
        self._movable = list(self._joints.values())
        self._master = self._joints[gripper.master_joint]
        self._gears: list[int] = []
        for joint in self._fingers():
            _p.setJointMotorControl2(body, joint, _p.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
        for link in gripper.finger_links:
            index = bullet.link_index(body, link)
            _p.changeDynamics(body, index, lateralFriction=PAD_FRICTION, physicsClientId=client)
        for follower in gripper.followers:
            if follower.multiplier != 0.0:
                self._make_intangible(self._joints[follower.joint])

    def joints_rad(self) -> dict[str, float]:
        """Every movable joint by name."""
        states = _p.getJointStates(self.body, self._movable, physicsClientId=self._bullet.id)
        return {name: float(state[0]) for name, state in zip(self._joints, states, strict=True)}

    def link_pose(self, link: str) -> Pose:
        """T_world_link."""
        index = self._bullet.link_index(self.body, link)
        if index < 0:
            return self._bullet.pose(self.body)
        state = _p.getLinkState(
            self.body, index, computeForwardKinematics=True, physicsClientId=self._bullet.id
        )
        return _pose((state[4], state[5]))

    def command_gripper(self, rad: float) -> None:
        """Target of the master joint for the coming steps."""
        g, client = self._gripper, self._bullet.id
        _p.setJointMotorControl2(
            self.body,
            self._master,
            _p.POSITION_CONTROL,
            targetPosition=rad,
            force=g.max_force,
            positionGain=g.position_gain,
            physicsClientId=client,
        )
        at_rad = _p.getJointState(self.body, self._master, physicsClientId=client)[0]
        for follower in g.followers:
            _p.setJointMotorControl2(
                self.body,
                self._joints[follower.joint],
                _p.POSITION_CONTROL,
                targetPosition=follower.multiplier * at_rad,
                force=follower.max_force,
                physicsClientId=client,
            )

    def _fingers(self) -> list[int]:
        g = self._gripper
        return [self._joints[n] for n in (g.master_joint, *(f.joint for f in (*g.gears, *g.followers)))]

    def _reset_fingers(self, rad: float) -> None:
        """Put the fingers at ``rad`` and couple them anew: gears remember where they were made."""
        client, g = self._bullet.id, self._gripper
        for gear in self._gears:
            _p.removeConstraint(gear, physicsClientId=client)
        _p.resetJointState(self.body, self._master, rad, 0.0, physicsClientId=client)
        for coupled in (*g.gears, *g.followers):
            at = coupled.multiplier * rad
            _p.resetJointState(self.body, self._joints[coupled.joint], at, 0.0, physicsClientId=client)
        self._gears = [
            self._couple(gear.joint, gear.multiplier, gear.max_force, gear.erp) for gear in g.gears
        ]
        self.command_gripper(rad)

    def _couple(self, joint: str, multiplier: float, max_force: float, erp: float) -> int:
        client, child = self._bullet.id, self._joints[joint]
        zero = [0.0, 0.0, 0.0]
        gear: int = _p.createConstraint(
            self.body,
            self._master,
            self.body,
            child,
            _p.JOINT_GEAR,
            [1, 0, 0],
            zero,
            zero,
            physicsClientId=client,
        )
        _p.changeConstraint(gear, gearRatio=-multiplier, maxForce=max_force, erp=erp, physicsClientId=client)
        return gear

    def _make_intangible(self, link: int) -> None:
        _p.setCollisionFilterGroupMask(self.body, link, 0, 0, physicsClientId=self._bullet.id)


class Robot(_Hand):
    """The arm with its hand inside one ``Bullet``."""

    def __init__(self, bullet: Bullet, body: int, model: RobotModel) -> None:
        super().__init__(bullet, body, model.description.gripper)
        self.model = model
        self._arm = [self._joints[name] for name in model.description.arm_joints]
        self._efforts = list(model.description.joint_effort_nm)
        self._position_gains = [0.3] * len(self._arm)
        self._velocity_gains = [1.0] * len(self._arm)

    def q(self) -> Array:
        """(dof,) rad."""
        return np.array([s[0] for s in self._states()])

    def qd(self) -> Array:
        """(dof,) rad/s."""
        return np.array([s[1] for s in self._states()])

    def command(self, q: Array, qd: Array) -> None:
        """Follow a reference that is at ``q`` (dof,) rad now and moves at ``qd`` (dof,) rad/s."""
        _p.setJointMotorControlArray(
            self.body,
            self._arm,
            _p.POSITION_CONTROL,
            targetPositions=q.tolist(),
            targetVelocities=qd.tolist(),
            forces=self._efforts,
            positionGains=self._position_gains,
            velocityGains=self._velocity_gains,
            physicsClientId=self._bullet.id,
        )

    def reset(self, q: Array, gripper_rad: float) -> None:
        """Be at rest at ``q`` (dof,) rad with the fingers at ``gripper_rad``, and stay there."""
        for joint, rad in zip(self._arm, q, strict=True):
            _p.resetJointState(self.body, joint, float(rad), 0.0, physicsClientId=self._bullet.id)
        self._reset_fingers(gripper_rad)
        self.command(q, np.zeros_like(q))

    def tcp(self) -> Pose:
        """T_world_tcp."""
        description = self.model.description
        return self.link_pose(description.flange_link) @ description.T_flange_tcp

    def self_contacts(self, within_m: float = 0.0) -> set[frozenset[str]]:
        """Pairs of links nearer than ``within_m``, but for the allowed pairs; for tests, not for control."""
        from backend.robots.self_contacts import checked_pairs

        found: set[frozenset[str]] = set()
        for a, b in checked_pairs(self.model):
            distance = self._bullet.link_distance_m(self.body, a, b, within_m)
            if distance is not None and distance < within_m:
                found.add(frozenset((a, b)))
        return found

    def _states(self) -> Sequence[Sequence[Any]]:
        return _p.getJointStates(self.body, self._arm, physicsClientId=self._bullet.id)


class HandAlone(_Hand):
    """The hand on a free base that a moved constraint holds: for lifts without an arm."""

    def __init__(self, bullet: Bullet, body: int, model: RobotModel, T_world_tcp: Pose) -> None:
        super().__init__(bullet, body, model.description.gripper)
        self.model = model
        self._T_tcp_root = model.T_handroot_tcp.inverse()
        root = T_world_tcp @ self._T_tcp_root
        bullet.set_pose(body, root)
        self._tie = bullet.tie_to_world(body, root, HAND_FORCE_N)
        self._reset_fingers(model.description.gripper.open_rad)

    def move_to(self, T_world_tcp: Pose) -> None:
        """Let the tcp be at ``T_world_tcp`` after the next step."""
        self._bullet.move_tie(self._tie, T_world_tcp @ self._T_tcp_root)

    def reset(self, T_world_tcp: Pose, gripper_rad: float) -> None:
        """Be at rest at ``T_world_tcp`` with the fingers at ``gripper_rad``."""
        self._bullet.set_pose(self.body, T_world_tcp @ self._T_tcp_root)
        self.move_to(T_world_tcp)
        self._reset_fingers(gripper_rad)

    def tcp(self) -> Pose:
        """T_world_tcp."""
        return self._bullet.pose(self.body) @ self.model.T_handroot_tcp


def _pose(frame: _Frame) -> Pose:
    (x, y, z, w) = frame[1]
    return Pose.of(frame[0], (w, x, y, z))


def _frame(pose: Pose) -> tuple[list[float], list[float]]:
    w, x, y, z = pose.wxyz.tolist()
    return pose.xyz_m.tolist(), [x, y, z, w]
