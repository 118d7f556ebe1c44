"""Episode: the only loop. ``run()`` yields snapshots; headless and live drivers differ only in when they ask."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Self

import numpy as np

from backend.cycle import Cycle
from backend.drawing import generators, setup_by
from backend.editing import Editing
from backend.errors import InvalidInputError, SimulationError
from backend.events import TimedEvent, WorldEvent
from backend.kinematics import load_kinematics
from backend.knowledge.grasps import load_grasps
from backend.objects import load_object
from backend.pilot import Pilot
from backend.pipeline.execute import Executor
from backend.pipeline.predict import make_predictor
from backend.pipeline.retime import JointLimits
from backend.pipeline.sense import Sensor
from backend.pipeline.think import ThinkTime
from backend.pipeline.values import Outcome
from backend.pose import Pose
from backend.record import Recorder
from backend.robots.models import load_model
from backend.scenario import Scenario
from backend.sim.planning_scene import PlanningScene
from backend.sim.world import World
from backend.snapshot import SceneDescription, Snapshot
from backend.tasks.judge import Judge
from backend.trajectory import Trajectory

STEPS_PER_TICK = 8
"""Snapshots come at 30 Hz of simulated time."""


class Episode:
    """One trial: a world, the robot's belief about it, and the loop that lets the robot act."""

    def __init__(self, scenario: Scenario, seed: int | None = None) -> None:
        """Raises ``InvalidInputError`` when no trial can begin so."""
        self.scenario = scenario
        self.seed = scenario.seed if seed is None else seed
        self.recorder = Recorder(scenario, self.seed)
        model = load_model(scenario.robot)
        kinematics = load_kinematics(scenario.robot)
        home = np.array(model.description.home_rad)
        task_rng, sense_rng, cycle_rng = generators(scenario, self.seed)
        self.setup = setup_by(scenario, task_rng)
        self.world = World(model, scenario.object, self.setup)
        self._judge = Judge(self.world)
        self._sensor = Sensor(scenario.sensing, sense_rng)
        self._belief = _planning_scene(self.world, PlanningScene(kinematics))
        profile = model.description.profiles[scenario.profile]
        limits = JointLimits(np.array(profile.velocity_rps), np.array(profile.acceleration_rps2))
        think = ThinkTime(scenario.timing)
        grasps = load_grasps(scenario.robot, scenario.object)
        cycle = Cycle(scenario.method, model.description, limits, kinematics, self._belief, grasps, think, cycle_rng)
        executor = Executor(kinematics, limits, scenario.method.execution, home)
        predictor = make_predictor(scenario.method.predictor, self._true_object_pose)
        self._pilot = Pilot(cycle, predictor, executor, think)
        self._kinematics = kinematics
        self._T_tray_object = self.world.tray_pose().inverse() @ self.world.object_pose()
        self._editing = Editing(self.world, self._belief, self._judge)
        self._tick = 0
        self.scene = self._describe()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the physics client back."""
        self.world.close()

    @property
    def in_force(self) -> Trajectory:
        """What the arm follows now."""
        return self._pilot.executor.in_force

    def check(self, event: WorldEvent) -> None:
        """Raises ``InvalidInputError`` for a live edit that ``apply`` would refuse now."""
        self._editing.check(event)

    def apply(self, event: WorldEvent) -> None:
        """Let a live edit act before the next tick, and record it, so that the edited trial can be repeated.

        Raises ``InvalidInputError``, with nothing changed, for one that cannot be.
        """
        self._editing.act(event)
        self.recorder.event(TimedEvent(tick=self._tick, event=event))

    def edited(self, snapshot: Snapshot) -> Snapshot:
        """The newest snapshot with what edits have changed since."""
        return replace(snapshot, **self._around())

    def run(self) -> Iterator[Snapshot]:
        """Yield a snapshot of the start and after every tick; the last one has an outcome."""
        snapshot = self._snapshot()
        yield snapshot
        while snapshot.outcome is None:
            outcome = self._tick_once()
            if outcome is None or outcome.reason != "error":
                snapshot = self._snapshot()
            if outcome is not None:
                snapshot = replace(snapshot, outcome=outcome, fingerprint=self.recorder.fingerprint())
            yield snapshot

    def finish(self) -> None:
        """Run the trial to its end unseen."""
        while self._tick_once() is None:
            pass

    def _tick_once(self) -> Outcome | None:
        """One tick, recorded; the outcome when it was the last."""
        try:
            for timed in self.scenario.events:
                if timed.tick == self._tick:
                    self._editing.act(timed.event)
                    self.recorder.event(timed)
            outcome = self._advance()
            self.recorder.tick(self.world.t_s, self.world.q(), self.world.object_pose())
        except (SimulationError, InvalidInputError) as error:
            outcome = Outcome(strict=False, authors=False, reason="error", detail=str(error))
        self._tick += 1
        if outcome is not None:
            self.recorder.end(outcome, self.world.t_s, self._pilot.approach_start_s)
        return outcome

    def _advance(self) -> Outcome | None:
        """One tick of physics steps, cut short by the end of the trial."""
        executor = self._pilot.executor
        for _ in range(STEPS_PER_TICK):
            t_s = self.world.t_s
            self._sensor.look(self.world)
            for observation in self._sensor.delivered(t_s):
                self._pilot.observe(observation)
            cycle = self._pilot.consider(t_s)
            if cycle is not None:
                self.recorder.cycle(cycle)
            self.world.handle(executor.phase not in ("watch", "move"))
            self.world.step(*executor.targets(t_s))
            self._change_phase()
            outcome = self._ended()
            if outcome is not None:
                return outcome
        return None

    def _change_phase(self) -> None:
        executor = self._pilot.executor
        before = executor.phase
        if before in ("watch", "move"):
            return
        executor.advance(self.world.t_s, self.world.gripper, self.world.finger_rad())
        if executor.phase == "close" and before == "approach":
            self._judge.note_grasp(self.world)
        if executor.phase in ("lift", "hold") and self.world.steps % STEPS_PER_TICK == 0:
            self._judge.note_height(self.world)
        if executor.phase == "hold" and before == "lift":
            self.recorder.lifted(self.world.t_s)

    def _ended(self) -> Outcome | None:
        """The outcome when the trial is over."""
        phase = self._pilot.executor.phase
        judge, world = self._judge, self.world
        if phase == "done":
            return judge.verdict(world, None, self._pilot.executor.lift_refusal or "")
        if world.t_s >= self.scenario.timing.timeout_s:
            return judge.verdict(world, "timeout", f"No grasp within {self.scenario.timing.timeout_s:g} s.")
        if phase not in ("watch", "move", "approach"):
            return None
        if world.steps % STEPS_PER_TICK == 0 and judge.fallen(world):
            return judge.verdict(world, "object_fell", "The object fell off the belt before it was grasped.")
        if phase != "approach" and world.conveyor.at_end:
            refusal = self._pilot.approach_refusal or _last_words(self._pilot)
            return judge.verdict(world, self._pilot.furthest_failure(), f"The belt came to its end; {refusal}.")
        return None

    def _true_object_pose(self, t_s: float) -> Pose:
        """Where the object will be at ``t_s`` if it stays on the belt."""
        return self.world.conveyor.pose_in(t_s - self.world.t_s) @ self._T_tray_object

    def _describe(self) -> SceneDescription:
        setup = self.setup
        return SceneDescription(
            robot=self.scenario.robot,
            object=self.scenario.object,
            tray_size_m=setup.tray_size_m,
            belt_path_world=setup.motion.path_world(120),
            obstacles=tuple(name for name, _ in setup.obstacles),
            slab=setup.slab,
            seed=self.seed,
        )

    def _around(self) -> dict[str, Any]:
        """What a snapshot says of obstacles and slab."""
        poses = [pose.matrix for pose in self.world.obstacle_poses()]
        return {
            "obstacles": self.world.obstacles,
            "Ts_world_obstacle": np.array(poses).reshape(-1, 4, 4),
            "slab": self.world.slab,
        }

    def _snapshot(self) -> Snapshot:
        world = self.world
        q = world.q()
        return Snapshot(
            tick=self._tick,
            t_s=world.t_s,
            phase=self._pilot.executor.phase,
            q=q,
            joints_rad=world.joints_rad(),
            T_world_tcp=Pose(self._kinematics.fk(q)),
            T_world_tray=world.tray_pose(),
            T_world_object=world.object_pose(),
            **self._around(),
            belt_rate=world.conveyor.rate,
            cycle=self._pilot.result,
            cycles=self._pilot.cycles,
            outcome=None,
            grip_n=0.0 if self._pilot.executor.phase in ("watch", "move", "approach") else world.grip_n(),
        )


def _planning_scene(world: World, scene: PlanningScene) -> PlanningScene:
    """Tell the planner what stands around: the models are known (paper, section III), their poses are detected."""
    for (name, _), pose in zip(world.setup.obstacles, world.obstacle_poses(), strict=True):
        scene.add_object(load_object(name), pose)
    if world.setup.slab is not None:
        scene.set_slab(world.setup.slab.size_m, world.setup.slab.T_world_box)
    scene.set_target(world.object, world.object_pose(), world.setup.tray_size_m, world.tray_pose())
    return scene


def _last_words(pilot: Pilot) -> str:
    """What the newest cycle had to say."""
    if pilot.result is None:
        return "the object was never seen"
    return pilot.result.why or "the hand never came near enough to the grasp"
