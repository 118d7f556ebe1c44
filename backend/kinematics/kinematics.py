"""Kinematics: forward and inverse kinematics and collision spheres of one robot, as one service."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import inverse as ik
from backend.kinematics.chain import Chain, body_rows, jacobian_of, matrix_of, row_of, rows_of, tcp_rows
from backend.kinematics.spheres import SphereModel
from backend.kinematics.urdf import LinkTree
from backend.pose import Array

if TYPE_CHECKING:
    from backend.robots.description import RobotDescription

SEED_POSTURES = 512
"""Size of the fixed table of postures that IK restarts from."""


@dataclass(frozen=True, eq=False)
class Kinematics:
    """What the joints of one arm mean in space. The base frame is the world frame."""

    description: RobotDescription
    tree: LinkTree
    chain: Chain
    spheres: SphereModel
    """Collision spheres with the hand fully open."""
    limits: Array
    """(2, dof) rad: lower, upper."""
    seeds: Array
    """(n, dof) rad, postures IK restarts from."""
    seed_rows: Array
    """(n, 12) where each puts the tcp."""
    yaw_sign: float
    """+1 or -1 when the first joint turns about the world's z or -z through the origin, else 0."""

    @property
    def dof(self) -> int:
        return self.chain.dof

    def fk(self, q: Array) -> Array:
        """(4, 4) T_world_tcp."""
        return matrix_of(tcp_rows(self.chain.links, _rows(q[None]))[0])

    def fk_many(self, qs: Array) -> Array:
        """(n, 4, 4) Ts_world_tcp of (n, dof)."""
        return matrix_of(tcp_rows(self.chain.links, _rows(qs)))

    def jacobian(self, q: Array) -> Array:
        """(6, dof) geometric Jacobian of the tcp in world axes: m/s rows first, then rad/s."""
        return jacobian_of(self.chain.links, _rows(q))

    def spheres_world(self, q: Array, gripper_rad: float | None = None) -> Array:
        """(n, 4) centre and radius of every collision sphere; None means the hand is open."""
        model = self.spheres if gripper_rad is None else self.spheres.with_gripper(gripper_rad)
        return model.world(body_rows(self.chain.links, _rows(q)))

    def ik(self, T_world_tcp: Array, q_seed: Array) -> Array | None:
        """(dof,) joints that put the tcp there, next to ``q_seed``; None when descent from it fails."""
        q = np.empty(self.dof)
        found = ik.solve_near(self.chain.links, self.limits[0], self.limits[1], row_of(T_world_tcp), _rows(q_seed), q)
        return q if found else None

    def ik_branches(self, T_world_tcp: Array, q_near: Array, max_branches: int = 8, tries: int = 20) -> Array:
        """(k, dof) distinct solutions within limits, k <= max_branches, nearest to ``q_near`` first.

        Joints are shifted by full turns to be nearest to ``q_near``. More ``tries`` find more branches.
        """
        found = ik.solve_branches(
            self.chain.links,
            self.limits,
            row_of(T_world_tcp),
            _rows(q_near),
            self.seeds,
            self.seed_rows,
            self.yaw_sign,
            tries,
        )
        return found[:max_branches]

    def ik_many(self, Ts_world_tcp: Array, q_near: Array, restarts: int = 24) -> tuple[Array, NDArray[np.bool_]]:
        """(n, dof) one solution per pose, NaN where none was found, and (n,) whether one was.

        The descent from ``q_near`` comes first, then up to ``restarts`` fixed postures near the pose.
        """
        return ik.solve_many(
            self.chain.links,
            self.limits,
            rows_of(Ts_world_tcp),
            _rows(q_near),
            self.seeds,
            self.seed_rows,
            self.yaw_sign,
            restarts,
        )

    def ik_each(self, Ts_world_tcp: Array, q_seeds: Array) -> tuple[Array, NDArray[np.bool_]]:
        """(n, dof) the solution next to each row of ``q_seeds`` (n, dof), NaN where descent from it fails."""
        return ik.solve_each(self.chain.links, self.limits, rows_of(Ts_world_tcp), _rows(q_seeds))

    def follow(self, Ts_world_tcp: Array, q_start: Array, max_joint_step_rad: float = 0.2) -> Array | None:
        """(m, dof) joints along (m, 4, 4) dense poses without a jump; None when a pose is not reached.

        No joint moves more than ``max_joint_step_rad`` between poses, nor from ``q_start`` to the first.
        """
        out, reached = ik.follow_rows(
            self.chain.links, self.limits, rows_of(Ts_world_tcp), _rows(q_start), max_joint_step_rad
        )
        return out if reached == len(Ts_world_tcp) else None

    def warm_up(self) -> None:
        """Compile, or load from disk, every kernel used here."""
        q = np.array(self.description.home_rad)
        T = self.fk(q)
        self.jacobian(q)
        self.spheres_world(q)
        self.ik(T, q)
        self.ik_branches(T, q, tries=1)
        self.ik_many(T[None], q, restarts=1)
        self.ik_each(T[None], q[None])
        self.follow(T[None], q)


@cache
def load_kinematics(robot_name: str) -> Kinematics:
    """The kinematics of a registered robot; raises ``NotFoundError``."""
    from backend.robots.models import load_model

    model = load_model(robot_name)
    return make_kinematics(model.description, LinkTree.from_urdf(model.collision_urdf), model.spheres)


def make_kinematics(description: RobotDescription, tree: LinkTree, spheres_of_link: dict[str, Array]) -> Kinematics:
    """Kinematics from the robot's tree and its links' spheres (n, 4) in link frames."""
    limits = np.array([description.joint_lower_rad, description.joint_upper_rad])
    chain = Chain.from_tree(tree, description.arm_joints, description.flange_link, description.T_flange_tcp)
    seeds = _postures(limits, SEED_POSTURES)
    first = chain.links[0]
    on_axis = abs(first[9]) + abs(first[10]) < 1e-9 and abs(abs(first[8]) - 1.0) < 1e-9
    return Kinematics(
        description=description,
        tree=tree,
        chain=chain,
        spheres=SphereModel.build(description, tree, chain, spheres_of_link),
        limits=limits,
        seeds=seeds,
        seed_rows=tcp_rows(chain.links, seeds),
        yaw_sign=float(np.sign(first[8])) if on_axis else 0.0,
    )


def _postures(limits: Array, count: int) -> Array:
    """(count, dof) Halton points within the limits; a joint that turns more than once is given one turn."""
    lower, upper = np.maximum(limits[0], -np.pi), np.minimum(limits[1], np.pi)
    whole = limits[1] - limits[0] >= 2.0 * np.pi
    lower, upper = np.where(whole, -np.pi, limits[0]), np.where(whole, np.pi, limits[1])
    primes = (2, 3, 5, 7, 11, 13, 17)
    unit = np.array([[_radical_inverse(i, p) for p in primes[: limits.shape[1]]] for i in range(1, count + 1)])
    return lower + unit * (upper - lower)


def _radical_inverse(index: int, base: int) -> float:
    """Digits of ``index`` mirrored at the point (van der Corput 1935)."""
    out, weight = 0.0, 1.0 / base
    while index:
        index, digit = divmod(index, base)
        out += digit * weight
        weight /= base
    return out


def _rows(q: Array) -> Array:
    return np.ascontiguousarray(q, dtype=np.float64)
