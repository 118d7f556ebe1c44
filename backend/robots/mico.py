"""Kinova Mico m1n6s200: six joints, curved wrist, two-finger hand."""

import math

from backend.pose import Pose
from backend.robots.description import (
    FollowerMotor,
    GearCoupling,
    GripperDescription,
    RobotDescription,
    SpeedProfile,
)

P = "m1n6s200_"
ENDLESS_RAD = 8.0 * math.pi
"""Continuous joints: four turns either way, more than any motion here winds up."""
FINGERS = tuple(f"{P}link_finger_{part}" for part in ("1", "tip_1", "2", "tip_2"))

HAND = GripperDescription(
    master_joint=f"{P}joint_finger_1",
    open_rad=0.0,
    closed_rad=1.3,
    close_speed_rps=2.0,
    max_force=4.0,
    position_gain=0.3,
    gears=(GearCoupling(f"{P}joint_finger_2", 1.0, 500.0, 0.3),),
    followers=(
        FollowerMotor(f"{P}joint_finger_tip_1", 0.0, 2.0),
        FollowerMotor(f"{P}joint_finger_tip_2", 0.0, 2.0),
    ),
    finger_links=FINGERS,
    hand_links=(f"{P}link_6", f"{P}end_effector", *FINGERS),
    opening_m=0.11,
    pad_depth_m=0.05,
)

MICO = RobotDescription(
    name="mico",
    title="Kinova Mico",
    arm_joints=tuple(f"{P}joint_{i}" for i in range(1, 7)),
    home_rad=(4.80469, 2.92482, 1.002, 4.20319, 1.4458, 1.3233),
    flange_link=f"{P}end_effector",
    T_flange_tcp=Pose.from_xyz_rpy((0.0, 0.0, 0.025), (0.0, 0.0, -math.pi / 2)),
    gripper=HAND,
    backoff_m=0.05,
    joint_lower_rad=(-ENDLESS_RAD, 0.872665, 0.610865, -ENDLESS_RAD, -ENDLESS_RAD, -ENDLESS_RAD),
    joint_upper_rad=(ENDLESS_RAD, 5.410521, 5.672320, ENDLESS_RAD, ENDLESS_RAD, ENDLESS_RAD),
    joint_effort_nm=(40.0, 80.0, 40.0, 20.0, 20.0, 20.0),
    profiles={
        "paper": SpeedProfile(
            velocity_rps=(0.35,) * 6,
            acceleration_rps2=(3.5,) * 6,
            source="speed: released evaluation of the paper; acceleration: full speed within 0.1 s, our choice",
        ),
        "datasheet": SpeedProfile(
            velocity_rps=(0.628,) * 3 + (0.838,) * 3,
            acceleration_rps2=(3.14,) * 3 + (4.19,) * 3,
            source="speed: kinova_description (36 and 48 deg/s); acceleration: full speed within 0.2 s, our choice",
        ),
    },
    allowed_self_contacts=frozenset(),
)
