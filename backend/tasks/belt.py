"""BeltTask: what the seven tasks share, the random belt of the paper (section V-A, random motion)."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from backend.config import Config
from backend.errors import InvalidInputError
from backend.motions import Motion
from backend.motions.belt import Point
from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose
from backend.tasks.clearance import can_begin
from backend.tasks.setup import TRAY_THICKNESS_M, TrialSetup, tray_size_m

ATTEMPTS = 500
FULL_TURN_RAD = 2.0 * np.pi

Speed = Annotated[float, Field(gt=0.0, le=0.5)]
Distance = Annotated[float, Field(ge=0.05, le=2.0)]
Angle = Annotated[float, Field(ge=-FULL_TURN_RAD, le=FULL_TURN_RAD)]
Height = Annotated[float, Field(ge=TRAY_THICKNESS_M / 2, le=1.0)]


@dataclass(frozen=True)
class DrawnBelt:
    """Where one belt lies, by the paper's theta, r and d, and the shares of whatever else is drawn."""

    theta_rad: float
    distance_m: float
    direction: Literal[1, -1]
    length_m: float
    start_height_share: float
    """In [0, 1)."""
    end_height_share: float
    object_yaw_rad: float

    @property
    def T_world_belt(self) -> Pose:
        """On the floor: origin where the line is nearest to the robot, x along the motion, y to its left."""
        yaw_rad = self.theta_rad + self.direction * np.pi / 2
        foot = self.distance_m * np.array([np.cos(self.theta_rad), np.sin(self.theta_rad), 0.0])
        return Pose.from_xyz_yaw(foot, yaw_rad)

    def ends(self, start_top_m: float = TRAY_THICKNESS_M, end_top_m: float = TRAY_THICKNESS_M) -> tuple[Point, Point]:
        """Start and end of the straight belt, at these heights of the tray's top face."""
        half = self.length_m / 2
        points = self.T_world_belt.transform_points(np.array([(-half, 0.0, start_top_m), (half, 0.0, end_top_m)]))
        (x0, y0, z0), (x1, y1, z1) = points.tolist()
        return (x0, y0, z0), (x1, y1, z1)


class BeltTask(Config):
    """A belt at a random place around the robot, whose base is the world's origin."""

    title: ClassVar[str]

    distance_min_m: Distance
    """Smallest distance of the belt from the robot's base (r in the paper)."""
    distance_max_m: Distance
    length_m: Annotated[float, Field(ge=0.1, le=3.0)] = 1.0
    """Of the belt, along its axis (l in the paper)."""
    theta_min_rad: Angle = 0.0
    """Smallest counter-clockwise angle of the perpendicular from base to belt (theta in the paper)."""
    theta_max_rad: Angle = FULL_TURN_RAD
    theta_rad: Angle | None = None
    """This angle instead of a drawn one."""
    distance_m: Distance | None = None
    """This distance instead of a drawn one."""
    direction: Literal[1, -1] | None = None
    """1 counter-clockwise around the robot, -1 clockwise (d in the paper); None: drawn."""

    @model_validator(mode="after")
    def _ranges_are_ordered(self) -> Self:
        if self.distance_min_m > self.distance_max_m:
            raise ValueError("distance_min_m must not exceed distance_max_m")
        if self.theta_min_rad > self.theta_max_rad:
            raise ValueError("theta_min_rad must not exceed theta_max_rad")
        return self

    @abstractmethod
    def motion(self, belt: DrawnBelt) -> Motion:
        """The tray's motion on a drawn belt."""

    def furnished(
        self,
        setup: TrialSetup,
        belt: DrawnBelt,
        target: ObjectDescription,
        arm_spheres_world: Array,
        rng: np.random.Generator,
    ) -> TrialSetup | None:
        """The setup with what else the task puts around the belt; None if there is no room for it."""
        return setup

    def draw(self, rng: np.random.Generator, target: ObjectDescription, arm_spheres_world: Array) -> TrialSetup:
        """How a trial begins, with everything clear of the arm at home (n, 4: x, y, z, radius).

        A belt is drawn again when tray, object or slab would start inside the arm, when it would carry the
        object into the robot's base, or when its obstacles find no room. ``rng`` gives two numbers whatever
        the task, and pinned values replace drawn ones, so pinning one leaves the others as they were.

        Raises ``InvalidInputError`` when no drawn belt is free.
        """
        belt_seed, furniture_seed = rng.integers(2**63, size=2)
        belt_rng = np.random.default_rng(belt_seed)
        furniture_rng = np.random.default_rng(furniture_seed)
        for _ in range(ATTEMPTS):
            belt = self._drawn(belt_rng.random(6))
            setup = self.laid(belt, target)
            if can_begin(setup, target, arm_spheres_world):
                whole = self.furnished(setup, belt, target, arm_spheres_world, furniture_rng)
                if whole is not None:
                    return whole
        raise InvalidInputError(self._no_room(target))

    def _drawn(self, shares: Array) -> DrawnBelt:
        theta, distance, direction, start, end, yaw = shares.tolist()
        return DrawnBelt(
            theta_rad=between(self.theta_min_rad, self.theta_max_rad, theta, self.theta_rad),
            distance_m=between(self.distance_min_m, self.distance_max_m, distance, self.distance_m),
            direction=self.direction or (1 if direction < 0.5 else -1),
            length_m=self.length_m,
            start_height_share=start,
            end_height_share=end,
            object_yaw_rad=np.pi - FULL_TURN_RAD * yaw,
        )

    def laid(self, belt: DrawnBelt, target: ObjectDescription) -> TrialSetup:
        return TrialSetup(
            motion=self.motion(belt),
            object_yaw_rad=belt.object_yaw_rad,
            tray_size_m=tray_size_m(target, belt.object_yaw_rad),
        )

    def _no_room(self, target: ObjectDescription) -> str:
        low, high = (self.distance_m,) * 2 if self.distance_m else (self.distance_min_m, self.distance_max_m)
        return (
            f"None of {ATTEMPTS} belts drawn for the task {self.title!r} leaves the {target.name} and its "
            f"surroundings clear of the robot. Distances drawn: {low:g} to {high:g} m; try larger ones, "
            "another theta, or fewer obstacles."
        )


def between(low: float, high: float, share: float, pinned: float | None = None) -> float:
    """The pinned value, or the one at ``share`` of the way from ``low`` to ``high``."""
    return low + share * (high - low) if pinned is None else pinned
