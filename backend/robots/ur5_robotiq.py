"""Universal Robots UR5 with a Robotiq 2F-85 on its tool flange."""

import math

from backend.pose import Pose
from backend.robots.description import (
    FollowerMotor,
    GearCoupling,
    GripperDescription,
    RobotDescription,
    SpeedProfile,
)

TWO_PI = 2.0 * math.pi
FINGER = ("outer_knuckle", "outer_finger", "inner_finger", "inner_finger_pad", "inner_knuckle")
FINGERS = tuple(f"{side}_{link}" for side in ("left", "right") for link in FINGER)

HAND = GripperDescription(
    master_joint="finger_joint",
    open_rad=0.0,
    closed_rad=0.8,
    close_speed_rps=1.0,
    max_force=10.0,
    position_gain=0.3,
    gears=(
        GearCoupling("right_outer_knuckle_joint", 1.0, 500.0, 0.3),
        GearCoupling("left_inner_finger_joint", -1.0, 500.0, 0.3),
        GearCoupling("right_inner_finger_joint", -1.0, 500.0, 0.3),
    ),
    followers=(
        FollowerMotor("left_inner_knuckle_joint", 1.0, 0.5),
        FollowerMotor("right_inner_knuckle_joint", 1.0, 0.5),
    ),
    finger_links=FINGERS,
    hand_links=("robotiq_arg2f_base_link", *FINGERS),
    opening_m=0.086,
    pad_depth_m=0.03,
)

UR5_ROBOTIQ = RobotDescription(
    name="ur5_robotiq",
    title="UR5 with Robotiq 2F-85",
    arm_joints=(
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    ),
    home_rad=(0.0, -1.15, 0.9, -0.660, 0.0, 0.0),
    flange_link="tool0",
    T_flange_tcp=Pose.from_xyz_rpy((0.0, 0.0, 0.140), (0.0, 0.0, 1.57)),
    gripper=HAND,
    backoff_m=0.075,
    joint_lower_rad=(-TWO_PI, -TWO_PI, -math.pi, -TWO_PI, -TWO_PI, -TWO_PI),
    joint_upper_rad=(TWO_PI, TWO_PI, math.pi, TWO_PI, TWO_PI, TWO_PI),
    joint_effort_nm=(150.0, 150.0, 150.0, 28.0, 28.0, 28.0),
    profiles={
        "paper": SpeedProfile(
            velocity_rps=(0.315,) * 6,
            acceleration_rps2=(3.15,) * 6,
            source="speed: released evaluation of the paper (a tenth of the data sheet's); "
            "acceleration: full speed within 0.1 s, our choice",
        ),
        "datasheet": SpeedProfile(
            velocity_rps=(3.15,) * 3 + (3.2,) * 3,
            acceleration_rps2=(6.3,) * 3 + (6.4,) * 3,
            source="speed: ur_description, UR5 data sheet (180 deg/s); "
            "acceleration: full speed within 0.5 s, our choice",
        ),
    },
    allowed_self_contacts=frozenset(
        {
            frozenset({"base_link", "upper_arm_link"}),
            frozenset({"forearm_link", "wrist_2_link"}),
            frozenset({"wrist_1_link", "wrist_3_link"}),
        }
    ),
)
