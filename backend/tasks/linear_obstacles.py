"""Linear motion among static obstacles that must not be knocked over."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from backend.motions import LinearMotion
from backend.objects import OBSTACLES, load_object
from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose
from backend.tasks.belt import BeltTask, DrawnBelt, Speed
from backend.tasks.clearance import ARM_CLEARANCE_M, cargo
from backend.tasks.linear import straight
from backend.tasks.prism import Prism, apart, clear_of_spheres
from backend.tasks.setup import TrialSetup

NEAR_M, FAR_M = 0.15, 0.25
"""The band around the belt's line that obstacles stand in."""
SUBREGIONS = 5
CLEARANCE_M = 0.01
DEALS = 20
TRIES_PER_SUBREGION = 40


@dataclass(frozen=True)
class Subregion:
    """A rectangle on the floor, in the belt's frame (x along the motion, y to its left)."""

    x_m: tuple[float, float]
    y_m: tuple[float, float]


class LinearObstacles(BeltTask):
    """Linear, with household objects standing beside the belt, each in its own sub-region."""

    title: ClassVar[str] = "Linear with obstacles"
    kind: Literal["linear_obstacles"] = "linear_obstacles"
    speed_mps: Speed
    obstacles: Annotated[int, Field(ge=0, le=SUBREGIONS)] = 3
    """How many; soup can, drill, bleach bottle, and again from the first."""

    def motion(self, belt: DrawnBelt) -> LinearMotion:
        return straight(belt, self.speed_mps)

    def furnished(
        self,
        setup: TrialSetup,
        belt: DrawnBelt,
        target: ObjectDescription,
        arm_spheres_world: Array,
        rng: np.random.Generator,
    ) -> TrialSetup | None:
        """With obstacles that touch neither each other, nor the arm at home, nor what the belt carries by.

        A place is drawn again while it is taken; a sub-region without a free place has the sub-regions dealt
        again; None when no deal works out.
        """
        names = [OBSTACLES[i % len(OBSTACLES)] for i in range(self.obstacles)]
        regions = subregions(belt)
        swept = swept_by_belt(setup, target)
        for _ in range(DEALS):
            chosen = [regions[i] for i in rng.permutation(SUBREGIONS)[: len(names)]]
            poses = _place_all(names, chosen, belt.T_world_belt, swept, arm_spheres_world, rng)
            if poses is not None:
                return replace(setup, obstacles=tuple(zip(names, poses, strict=True)))
        return None


def subregions(belt: DrawnBelt) -> tuple[Subregion, ...]:
    """Five rectangles of a third of the belt's length in the band from 15 to 25 cm beside its line.

    Three lie beyond the belt as seen from the robot, two on its near side at the belt's ends: the near middle
    is where the robot stands.
    """
    a, b = belt.length_m / 2, belt.length_m / 6
    beyond, near = ((-FAR_M, -NEAR_M), (NEAR_M, FAR_M))[:: belt.direction]
    thirds = ((-a, -b), (-b, b), (b, a))
    return (*(Subregion(x, beyond) for x in thirds), Subregion(thirds[0], near), Subregion(thirds[2], near))


def swept_by_belt(setup: TrialSetup, target: ObjectDescription) -> tuple[Prism, Prism]:
    """What the tray and the object pass through on a straight belt."""
    before = cargo(setup, target, setup.motion.pose_at(0.0))
    after = cargo(setup, target, setup.motion.pose_at(setup.motion.duration_s))
    return before[0].joined(after[0]), before[1].joined(after[1])


def _place_all(
    names: list[str],
    regions: list[Subregion],
    T_world_belt: Pose,
    swept: tuple[Prism, ...],
    arm_spheres_world: Array,
    rng: np.random.Generator,
) -> list[Pose] | None:
    """T_world_obstacle of each name in its region, or None when one finds no place."""
    taken, poses = list(swept), list[Pose]()
    for name, region in zip(names, regions, strict=True):
        obstacle = load_object(name)
        for _ in range(TRIES_PER_SUBREGION):
            pose = T_world_belt @ _somewhere(region, rng)
            solid = Prism.of_object(obstacle, pose)
            clear = clear_of_spheres(solid, arm_spheres_world, ARM_CLEARANCE_M)
            if clear and all(apart(solid, other, CLEARANCE_M) for other in taken):
                taken.append(solid)
                poses.append(pose)
                break
        else:
            return None
    return poses


def _somewhere(region: Subregion, rng: np.random.Generator) -> Pose:
    """T_belt_obstacle, uniform in place and yaw."""
    x, y, yaw = rng.uniform((region.x_m[0], region.y_m[0], -np.pi), (region.x_m[1], region.y_m[1], np.pi))
    return Pose.from_xyz_yaw((x, y, 0.0), yaw)
