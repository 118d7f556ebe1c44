"""The robots: pure descriptions here, geometry made from them in ``models``."""

from backend.robots.description import RobotDescription
from backend.robots.mico import MICO
from backend.robots.ur5_robotiq import UR5_ROBOTIQ

ROBOTS: dict[str, RobotDescription] = {robot.name: robot for robot in (MICO, UR5_ROBOTIQ)}
