"""Method: which occupant each room of the pipeline has, and with which settings."""

from typing import Annotated, Literal

from pydantic import Field

from backend.config import Config, NonNegativeFloat, PositiveFloat


class ConstantVelocity(Config):
    """Straight on, with the velocity of a least-squares line through the newest observations."""

    kind: Literal["constant_velocity"] = "constant_velocity"
    window_s: Annotated[float, Field(ge=0.05, le=10.0)] = 0.5


class Kalman(Config):
    """Kalman filter on position and yaw with white-noise acceleration, aware of the time between observations."""

    kind: Literal["kalman"] = "kalman"
    acceleration_std_mps2: Annotated[float, Field(gt=0.0, le=10.0)] = 0.005
    measurement_std_m: Annotated[float, Field(gt=0.0, le=0.1)] = 0.001


class Lstm(Config):
    """The paper's recurrent network, trained on linear, circular and sinusoidal motion (section IV-A)."""

    kind: Literal["lstm"] = "lstm"


class LastPose(Config):
    """No prediction: the object stays where it was last seen."""

    kind: Literal["last_pose"] = "last_pose"


class Oracle(Config):
    """The true motion; for tests and upper bounds only."""

    kind: Literal["oracle"] = "oracle"


PredictorConfig = Annotated[ConstantVelocity | Kalman | Lstm | LastPose | Oracle, Field(discriminator="kind")]


class IkFilter(Config):
    """Solve IK for the whole database at the predicted pose and keep the best reachable grasps."""

    kind: Literal["ik"] = "ik"
    keep: Annotated[int, Field(ge=1, le=100)] = 10


class RandomFilter(Config):
    """Keep random grasps, the paper's baseline."""

    kind: Literal["random"] = "random"
    keep: Annotated[int, Field(ge=1, le=100)] = 10


class Reachability(Config):
    """Keep the grasps that lie furthest inside the reachable set, by a field computed beforehand (section IV-C)."""

    kind: Literal["reachability"] = "reachability"
    keep: Annotated[int, Field(ge=1, le=100)] = 10
    varied: bool = True
    """Of grasps much alike only the best is kept, so that one of those kept is near; the paper keeps them all."""


class MotionAware(Config):
    """Keep the grasps likeliest to hold in the predicted motion, by a model trained beforehand (section IV-C)."""

    kind: Literal["motion_aware"] = "motion_aware"
    keep: Annotated[int, Field(ge=1, le=100)] = 10
    varied: bool = True
    """Of grasps much alike only the best is kept, so that one of those kept is near; the paper keeps them all."""


class ReachabilityMotion(Config):
    """R+M: keep the best by reachability and the best by motion-aware quality (section IV-C)."""

    kind: Literal["reachability_motion"] = "reachability_motion"
    keep_each: Annotated[int, Field(ge=1, le=50)] = 5
    """Of either kind; a grasp that is among both is kept once."""
    varied: bool = True
    """In either kind, of grasps much alike only the best is kept, so that one is near; the paper keeps them all."""


FilterConfig = Annotated[
    IkFilter | RandomFilter | Reachability | MotionAware | ReachabilityMotion, Field(discriminator="kind")
]


class RrtConnect(Config):
    """OMPL's RRT-Connect in compiled collision checks."""

    kind: Literal["rrt_connect"] = "rrt_connect"
    seeded: bool = True
    """Start the tree with what is left of the previous path."""
    max_checks: Annotated[int, Field(ge=100, le=1_000_000)] = 20_000
    """Budget of state checks; counted, so that a seed gives the same path on any machine."""


class Prm(Config):
    """OMPL's PRM in compiled collision checks, the paper's choice (section IV-D)."""

    kind: Literal["prm"] = "prm"
    seeded: bool = True
    """Initialise the roadmap with the previous waypoints."""
    max_checks: Annotated[int, Field(ge=100, le=1_000_000)] = 20_000
    """Budget of state checks; counted, so that a seed gives the same path on any machine."""


class Chomp(Config):
    """Covariant Hamiltonian optimisation in compiled kernels: bends a path until it touches nothing."""

    kind: Literal["chomp"] = "chomp"
    seeded: bool = True
    """Begin with what is left of the previous path, joined to the new goal."""
    iterations: Annotated[int, Field(ge=1, le=10_000)] = 30
    """Steps down from each beginning; counted, so that a seed gives the same path on any machine."""
    waypoints: Annotated[int, Field(ge=3, le=200)] = 24
    """That are moved, besides the two ends."""
    goals: Annotated[int, Field(ge=1, le=40)] = 4
    """How many of the free goals are tried, preferred first."""
    bends: Annotated[int, Field(ge=0, le=100)] = 12
    """How many bent lines are tried after the straight one, spread over those goals."""
    reach_m: Annotated[float, Field(ge=0.005, le=0.5)] = 0.05
    """Distances below this cost."""
    smoothness: Annotated[float, Field(gt=0.0, le=10.0)] = 1e-4
    """Weight of the squared accelerations against the obstacle cost."""


class FastLadder(Config):
    """Straight edge, previous path reconnected, own trees with shortcuts; compiled, over all grasps picked at once."""

    kind: Literal["fast"] = "fast"
    seeded: bool = True
    """Reconnect the previous path, and begin trees with what still holds of it."""
    max_checks: Annotated[int, Field(ge=100, le=1_000_000)] = 50_000
    """Budget of state checks; counted, so that a seed gives the same path on any machine."""


PlannerConfig = Annotated[RrtConnect | Prm | Chomp | FastLadder, Field(discriminator="kind")]


class Toppra(Config):
    """Time-optimal within velocity and acceleration limits, from the arm's current velocity."""

    kind: Literal["toppra"] = "toppra"
    grid_points: Annotated[int, Field(ge=50, le=1000)] = 100


class Fast(Config):
    """As ``Toppra``, by an own compiled pass; a moving arm with one straight edge before it takes the least time."""

    kind: Literal["fast"] = "fast"


RetimerConfig = Annotated[Toppra | Fast, Field(discriminator="kind")]


class StepHorizon(Config):
    """The paper's step function of the distance from hand to pregrasp (section IV-A)."""

    kind: Literal["step"] = "step"
    near_m: PositiveFloat = 0.1
    far_m: PositiveFloat = 0.3
    near_s: NonNegativeFloat = 0.0
    middle_s: NonNegativeFloat = 1.0
    far_s: NonNegativeFloat = 2.0


class Intercept(Config):
    """As far ahead as arm and grasp will meet: when the motion in force ends, or later where the object is too fast."""

    kind: Literal["intercept"] = "intercept"
    longest_s: PositiveFloat = 8.0
    """Predictions reach no further."""


HorizonConfig = Annotated[StepHorizon | Intercept, Field(discriminator="kind")]


class Execution(Config):
    """How the grasp is carried out once CanGrasp holds."""

    position_factor: Annotated[float, Field(ge=1.0, le=2.0)] = 1.1
    """CanGrasp: the tcp is within this factor of the back-off distance from the grasp."""
    angle_rad: Annotated[float, Field(gt=0.0, le=1.6)] = 0.349
    """CanGrasp: largest difference in orientation, 20 degrees in the paper."""
    approach_s: Annotated[float, Field(gt=0.1, le=5.0)] = 1.0
    """Shortest duration of the approach, and its prediction horizon (t' in the paper)."""
    close_s: Annotated[float, Field(gt=0.0, le=3.0)] = 0.1
    """How long the hand at least moves along while it closes (t'' in the paper)."""
    tracking: bool = True
    """Correct the approach with every new observation."""
    lift_m: Annotated[float, Field(ge=0.05, le=0.5)] = 0.1
    hold_s: Annotated[float, Field(ge=0.1, le=5.0)] = 1.0


class Method(Config):
    """One way to grasp a moving object, room by room."""

    name: str
    title: str
    predictor: PredictorConfig = Lstm()
    horizon: HorizonConfig = Intercept()
    filter: FilterConfig = IkFilter()
    planner: PlannerConfig = RrtConnect()
    retimer: RetimerConfig = Fast()
    execution: Execution = Execution()
    rehearsal: bool = True
    """Go for a grasp, and in for it, only when the way in and the lift have been found free, and by no way that
    pushes the moving object; the paper's arm finds out on the spot."""
