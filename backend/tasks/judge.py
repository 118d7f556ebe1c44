"""Judge: what a trial has come to, by the strict rule and by the rule of the paper's released evaluation."""

import numpy as np

from backend.pipeline.values import FailureReason, Outcome
from backend.pose import Pose
from backend.sim.world import World

LIFTED_M = 0.05
AUTHORS_LIFTED_M = 0.03
KNOCKED_M = 0.02
KNOCKED_RAD = np.radians(10.0)
FALLEN_M = 0.03


class Judge:
    """Remembers how things stood at the start and at the grasp."""

    def __init__(self, world: World) -> None:
        self._hand_links = set(world.model.description.gripper.hand_links)
        self._start_z_m = float(world.object_pose().xyz_m[2])
        self._obstacles = world.obstacle_poses()
        self._grasp_z_m: float | None = None
        self._highest_m = -np.inf

    def obstacle_moved(self, index: int, T_world_obstacle: Pose) -> None:
        """People moved an obstacle: from now on it belongs there."""
        self._obstacles[index] = T_world_obstacle

    def obstacle_added(self, T_world_obstacle: Pose) -> None:
        """People put one more there."""
        self._obstacles.append(T_world_obstacle)

    def obstacle_removed(self, index: int) -> None:
        """People took one away."""
        del self._obstacles[index]

    def note_grasp(self, world: World) -> None:
        """The fingers begin to close: success is measured from this height."""
        self._grasp_z_m = float(world.object_pose().xyz_m[2])

    def note_height(self, world: World) -> None:
        """Keep the greatest height since the grasp, to tell a drop from a miss."""
        self._highest_m = max(self._highest_m, float(world.object_pose().xyz_m[2]))

    def fallen(self, world: World) -> bool:
        """Whether the object has left the tray downwards."""
        z = world.object_pose().xyz_m[2]
        if z - world.conveyor.xyz_m[2] > -0.5 * FALLEN_M:  # the tray is where its belt is to a tenth of a millimetre
            return False
        return float(z - world.tray_pose().xyz_m[2]) < -FALLEN_M

    def knocked(self, world: World) -> str | None:
        """Which obstacle is not where it belongs; None if all are."""
        for name, before, now in zip(world.obstacles, self._obstacles, world.obstacle_poses(), strict=True):
            moved = float(np.linalg.norm(now.xyz_m - before.xyz_m))
            tilt = float(np.arccos(np.clip(now.rotation[:, 2] @ before.rotation[:, 2], -1.0, 1.0)))
            if moved > KNOCKED_M or tilt > KNOCKED_RAD:
                return f"{name} was moved by {moved * 100:.1f} cm and tilted by {np.degrees(tilt):.0f} degrees"
        return None

    def verdict(self, world: World, ended: FailureReason | None, detail: str) -> Outcome:
        """The outcome; ``ended`` says why the trial was cut short, None when the hold was completed."""
        z = float(world.object_pose().xyz_m[2])
        authors = z >= self._start_z_m + AUTHORS_LIFTED_M
        reason, words = self._reason(world, z, ended, detail)
        return Outcome(strict=reason is None, authors=authors, reason=reason, detail=words)

    def _reason(
        self, world: World, z: float, ended: FailureReason | None, detail: str
    ) -> tuple[FailureReason | None, str]:
        knocked = self.knocked(world)
        if ended is not None:
            return ended, detail
        assert self._grasp_z_m is not None
        risen = z - self._grasp_z_m
        if risen < LIFTED_M:
            if self._highest_m - self._grasp_z_m >= AUTHORS_LIFTED_M:
                where = f"{abs(risen) * 100:.1f} cm {'above' if risen >= 0.0 else 'below'} where it was grasped"
                return "dropped", f"The object was lifted and lost; it ended {where}."
            return "approach_missed", detail or "The hand closed, but the object did not come up with it."
        links, others = world.touching_object()
        if others or not links or not links <= self._hand_links:
            return "dropped", "At the end the object was not held by the hand alone."
        if knocked is not None:
            return "knocked_obstacle", f"The object was lifted, but the {knocked}."
        return None, f"Lifted by {risen * 100:.1f} cm and held."
