"""What a robot looks like on the page: as in films."""

from backend.robots.looks import LinkPart, RobotParts, load_robot_parts, open_hand

__all__ = ["LinkPart", "RobotParts", "load_robot_parts", "open_hand"]
