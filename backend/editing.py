"""Editing: live edits of a running trial, in the world, in the robot's belief and before the judge alike."""

from __future__ import annotations

from backend.errors import InvalidInputError
from backend.events import MOST_OBSTACLES, AddObstacle, MoveObstacle, RemoveObstacle, SetBeltRate, SetSlab, WorldEvent
from backend.objects import load_object
from backend.pose import Pose
from backend.sim.planning_scene import PlanningScene
from backend.sim.world import World, upright
from backend.tasks.judge import Judge
from backend.tasks.prism import Prism, apart, clear_of_spheres
from backend.tasks.slab import slab_above


class Editing:
    """Of one trial. What is refused has changed nothing: two trials in step ask ``check`` of both first."""

    def __init__(self, world: World, belief: PlanningScene, judge: Judge) -> None:
        self._world = world
        self._belief = belief
        self._judge = judge

    def check(self, event: WorldEvent) -> None:
        """Raises ``InvalidInputError`` for an obstacle that is not there, and for what would stand in something."""
        world = self._world
        match event:
            case SetBeltRate():
                pass
            case MoveObstacle() | RemoveObstacle():
                index = world.obstacle(event.index)
                if isinstance(event, MoveObstacle):
                    self._check_room(world.obstacles[index], upright(event), besides=index)
            case AddObstacle():
                if (there := len(world.obstacles)) >= MOST_OBSTACLES:
                    raise InvalidInputError(f"There are {there} obstacles already, and no more are possible.")
                self._check_room(event.object, upright(event))
            case SetSlab(height_m=height_m):
                if height_m is not None:
                    slab = slab_above(world.setup.motion, height_m)
                    self._check_clear(Prism.of_box(slab.size_m, slab.T_world_box), "The slab")

    def act(self, event: WorldEvent) -> None:
        """Raises like ``check``, with nothing changed."""
        self.check(event)
        world, belief, judge = self._world, self._belief, self._judge
        world.apply(event)
        match event:
            case SetBeltRate():
                pass
            case MoveObstacle(index=index):
                pose = world.obstacle_poses()[index]
                judge.obstacle_moved(index, pose)
                belief.move_obstacle(index, pose)
            case AddObstacle():
                pose = world.obstacle_poses()[-1]
                judge.obstacle_added(pose)
                belief.add_object(load_object(event.object), pose)
            case RemoveObstacle(index=index):
                judge.obstacle_removed(index)
                belief.remove_obstacle(index)
            case SetSlab():
                if world.slab is None:
                    belief.remove_slab()
                else:
                    belief.set_slab(world.slab.size_m, world.slab.T_world_box)

    def _check_room(self, name: str, T_world_obstacle: Pose, besides: int | None = None) -> None:
        """Whether an obstacle can stand there; ``besides`` is itself where it was before."""
        world = self._world
        solid, what = Prism.of_object(load_object(name), T_world_obstacle), f"The {name}"
        self._check_clear(solid, what)
        for i, (other, pose) in enumerate(zip(world.obstacles, world.obstacle_poses(), strict=True)):
            if i != besides and _overlap(solid, Prism.of_object(load_object(other), pose)):
                raise InvalidInputError(f"{what} would stand in the {other}: choose another place.")
        if world.slab is not None and _overlap(solid, Prism.of_box(world.slab.size_m, world.slab.T_world_box)):
            raise InvalidInputError(f"{what} would stand in the slab: choose another place.")

    def _check_clear(self, solid: Prism, what: str) -> None:
        """Of the arm, the tray and the object where they are now."""
        world = self._world
        if not clear_of_spheres(solid, self._belief.kinematics.spheres_world(world.q()), 0.0):
            raise InvalidInputError(f"{what} would stand in the arm: choose another place, or wait until it has moved.")
        T_world_box = world.tray_pose() @ Pose.of((0.0, 0.0, -world.setup.tray_size_m[2] / 2))
        carried = (
            (Prism.of_box(world.setup.tray_size_m, T_world_box), "tray"),
            (Prism.of_object(world.object, world.object_pose()), world.object.name),
        )
        for other, name in carried:
            if _overlap(solid, other):
                raise InvalidInputError(f"{what} would stand in the {name}: choose another place, or wait.")


def _overlap(a: Prism, b: Prism) -> bool:
    """Of two upright solids."""
    return a.low_m < b.high_m and b.low_m < a.high_m and not apart(a, b, 0.0)
