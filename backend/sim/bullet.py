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
from backend.robots.models import RobotModel
from backend.sim.gripper import GripperDrive
from backend.sim.hand import HandAlone
from backend.sim.object_files import object_mesh_file
from backend.sim.robot import Robot

__all__ = ["SOLVER_ITERATIONS", "STEP_S", "Bullet", "Contact", "GripperDrive", "HandAlone", "Robot"]

STEP_S = 1 / 240
SOLVER_ITERATIONS = 100
GRAVITY_MPS2 = 9.81
FLOOR_FRICTION = 1.0
SPINNING_FRICTION = 0.002
TIE_ERP = 0.8
"""Share of a tie's error that one step removes; PyBullet has one figure for all joint constraints."""
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

    def set_solver_iterations(self, count: int) -> None:
        """How often at most the coming steps go through all contacts, motors and ties."""
        _p.setPhysicsEngineParameter(numSolverIterations=count, physicsClientId=self.id)

    def remember(self) -> int:
        """Keep where everything is and how it moves; returns a number for ``recall``."""
        state: int = _p.saveState(physicsClientId=self.id)
        return state

    def recall(self, state: int) -> None:
        """Put everything back to where it was. Motors and ties keep what they were last asked for."""
        _p.restoreState(stateId=state, physicsClientId=self.id)

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
        self._register(body, Pose(T_object_inertial), description.lateral_friction, description.spinning_friction)
        self.set_pose(body, T_world_object)
        return body

    def add_box(
        self, size_m: Sequence[float], T_world_box: Pose, *, mass_kg: float = 0.0, friction: float = 1.0
    ) -> int:
        """A box of uniform density, fixed when it has no mass."""
        shape = _p.createCollisionShape(_p.GEOM_BOX, halfExtents=[s / 2 for s in size_m], physicsClientId=self.id)
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

    def remove_body(self, body: int) -> None:
        """Take a body out of the world."""
        _p.removeBody(body, physicsClientId=self.id)
        for known in (self._links, self._names, self._T_base_inertial, self._T_inertial_base):
            known.pop(body)

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
        _p.changeConstraint(constraint, jointChildPivot=xyz, jointChildFrameOrientation=xyzw, physicsClientId=self.id)

    def shift_tie(self, constraint: int, xyz_m: Array) -> None:
        """The same without turning."""
        _p.changeConstraint(constraint, jointChildPivot=xyz_m.tolist(), physicsClientId=self._id)

    def carry(self, body: int, xyz_m: Sequence[float], wxyz: Sequence[float], velocity_mps: Sequence[float]) -> None:
        """Drive a free, heavy, symmetric body through the coming step: from a position, at a velocity.

        Bullet's kinematic bodies stand still for friction, and a tie lags behind and jerks at the start; a
        body put on its way before every step, against gravity, carries its load without slip.
        """
        w, x, y, z = wxyz
        vx, vy, vz = velocity_mps
        _p.resetBasePositionAndOrientation(body, xyz_m, (x, y, z, w), physicsClientId=self._id)
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
        points = _p.getClosestPoints(body, body, within_m, linkIndexA=a, linkIndexB=b, physicsClientId=self.id)
        return min((float(point[8]) for point in points), default=None)

    def joints(self, body: int) -> dict[str, int]:
        """The body's movable joints: name -> PyBullet's number."""
        count: int = _p.getNumJoints(body, physicsClientId=self.id)
        infos = [_p.getJointInfo(body, i, physicsClientId=self.id) for i in range(count)]
        return {info[1].decode(): info[0] for info in infos if info[2] != _p.JOINT_FIXED}

    def joint_states(self, body: int, joints: list[int]) -> Sequence[Sequence[float]]:
        """(position, velocity, ...) of each joint."""
        return _p.getJointStates(body, joints, physicsClientId=self.id)

    def reset_joint(self, body: int, joint: int, rad: float, rate_rps: float = 0.0) -> None:
        """Put a joint at ``rad``, moving at ``rate_rps``."""
        _p.resetJointState(body, joint, rad, rate_rps, physicsClientId=self.id)

    def drive(self, body: int, joint: int, rad: float, max_force: float, gain: float) -> None:
        """A position motor on one joint."""
        _p.setJointMotorControl2(
            body,
            joint,
            _p.POSITION_CONTROL,
            targetPosition=rad,
            force=max_force,
            positionGain=gain,
            physicsClientId=self.id,
        )

    def drive_all(
        self,
        body: int,
        joints: list[int],
        q: list[float],
        qd: list[float],
        max_force: list[float],
        gains: list[float],
    ) -> None:
        """Position motors with velocity feed-forward on many joints, in one call."""
        _p.setJointMotorControlArray(
            body,
            joints,
            _p.POSITION_CONTROL,
            targetPositions=q,
            targetVelocities=qd,
            forces=max_force,
            positionGains=gains,
            physicsClientId=self.id,
        )

    def release(self, body: int, joint: int) -> None:
        """Switch off the motor that PyBullet gives every joint."""
        _p.setJointMotorControl2(body, joint, _p.VELOCITY_CONTROL, force=0.0, physicsClientId=self.id)

    def gear(self, body: int, master: int, child: int, multiplier: float, max_force: float, erp: float) -> int:
        """Couple two joints of a body, ``q_child = multiplier * q_master``; returns the constraint."""
        zero = [0.0, 0.0, 0.0]
        gear: int = _p.createConstraint(
            body, master, body, child, _p.JOINT_GEAR, [1, 0, 0], zero, zero, physicsClientId=self.id
        )
        _p.changeConstraint(gear, gearRatio=-multiplier, maxForce=max_force, erp=erp, physicsClientId=self.id)
        return gear

    def remove_constraint(self, constraint: int) -> None:
        """Undo ``tie_to_world`` or ``gear``."""
        _p.removeConstraint(constraint, physicsClientId=self.id)

    def set_friction(self, body: int, link: str, friction: float) -> None:
        """Lateral friction of a link; a contact has the product of both sides'."""
        index = self.link_index(body, link)
        _p.changeDynamics(body, index, lateralFriction=friction, physicsClientId=self.id)

    def make_intangible(self, body: int, joint: int) -> None:
        """Let the link behind a joint pass through everything."""
        _p.setCollisionFilterGroupMask(body, joint, 0, 0, physicsClientId=self.id)

    def link_pose(self, body: int, link: str) -> Pose:
        """T_world_link."""
        index = self.link_index(body, link)
        if index < 0:
            return self.pose(body)
        state = _p.getLinkState(body, index, computeForwardKinematics=True, physicsClientId=self.id)
        return _pose((state[4], state[5]))

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

    def _register(self, body: int, T_base_inertial: Pose, friction: float, spinning: float = SPINNING_FRICTION) -> int:
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


def _pose(frame: _Frame) -> Pose:
    (x, y, z, w) = frame[1]
    return Pose.of(frame[0], (w, x, y, z))


def _frame(pose: Pose) -> tuple[list[float], list[float]]:
    w, x, y, z = pose.wxyz.tolist()
    return pose.xyz_m.tolist(), [x, y, z, w]
