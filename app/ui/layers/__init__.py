"""LAYERS: everything in the 3-D scene, in the order it is built."""

from app.ui.layers.all_grasps import AllGraspsLayer
from app.ui.layers.bodies import ObjectLayer, ObstaclesLayer
from app.ui.layers.conveyor import ConveyorLayer
from app.ui.layers.grasps import GraspsLayer
from app.ui.layers.layer import Layer, Picture
from app.ui.layers.paths import PlansLayer, PredictionLayer, TrailLayer
from app.ui.layers.reach import ReachLayer
from app.ui.layers.robot import RobotLayer

LAYERS: tuple[type[Layer], ...] = (
    ConveyorLayer,
    RobotLayer,
    ObjectLayer,
    ObstaclesLayer,
    PredictionLayer,
    AllGraspsLayer,
    GraspsLayer,
    PlansLayer,
    TrailLayer,
    ReachLayer,
)

__all__ = ["LAYERS", "Layer", "Picture"]
