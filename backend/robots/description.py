"""What a robot is: its joints, hand, limits and frames. Pure data; the geometry is made by ``models``."""

from dataclasses import dataclass
from typing import Literal

from backend.pose import Pose

ProfileName = Literal["paper", "datasheet"]


@dataclass(frozen=True)
class SpeedProfile:
    """Joint limits that retiming obeys."""

    velocity_rps: tuple[float, ...]
    """(dof,) rad/s."""
    acceleration_rps2: tuple[float, ...]
    """(dof,) rad/s^2."""
    source: str
    """Where the figures come from."""


@dataclass(frozen=True)
class GearCoupling:
    """A finger joint that follows the master by a gear constraint: ``q_child = multiplier * q_master``."""

    joint: str
    multiplier: float
    max_force: float
    erp: float


@dataclass(frozen=True)
class FollowerMotor:
    """A finger joint kept at ``multiplier * q_master`` by a weak position motor."""

    joint: str
    multiplier: float
    max_force: float


@dataclass(frozen=True)
class GripperDescription:
    """A two-finger hand driven by one master joint."""

    master_joint: str
    open_rad: float
    closed_rad: float
    close_speed_rps: float
    """Speed at which the master's target is ramped."""
    max_force: float
    """Force limit of the master's motor, N m."""
    position_gain: float
    gears: tuple[GearCoupling, ...]
    followers: tuple[FollowerMotor, ...]
    finger_links: tuple[str, ...]
    """Links that may touch the target while grasping."""
    hand_links: tuple[str, ...]
    """All links of the hand, palm and fingers: what the hand alone consists of."""
    opening_m: float
    """Largest distance between the pads."""
    pad_depth_m: float
    """How far from the tcp towards the palm an object's surface may lie without touching the palm."""


@dataclass(frozen=True)
class RobotDescription:
    """One arm with its hand. The base frame is the world frame."""

    name: str
    title: str
    arm_joints: tuple[str, ...]
    """(dof,) names, base to wrist."""
    home_rad: tuple[float, ...]
    flange_link: str
    """The link the tcp is fixed to."""
    T_flange_tcp: Pose
    """tcp: midway between the closed pads; z is the approach direction, y the fingers' closing direction."""
    gripper: GripperDescription
    backoff_m: float
    """Distance of the pregrasp behind the grasp, along the approach (b in the paper)."""
    joint_lower_rad: tuple[float, ...]
    joint_upper_rad: tuple[float, ...]
    joint_effort_nm: tuple[float, ...]
    profiles: dict[ProfileName, SpeedProfile]
    allowed_self_contacts: frozenset[frozenset[str]]
    """Pairs of links that may touch or overlap in any pose (beyond neighbours in the chain): they
    pass each other so closely that their spheres overlap in up to 99 % of random poses, while their hulls, wider
    than the links, touch in at most 6 %, by millimetres."""

    @property
    def dof(self) -> int:
        return len(self.arm_joints)
