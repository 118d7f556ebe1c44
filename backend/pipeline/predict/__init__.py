"""predict: Observations -> Prediction. One file per predictor."""

from backend.methods.method import ConstantVelocity, Kalman, LastPose, Lstm, Oracle, PredictorConfig
from backend.pipeline.predict.constant_velocity import ConstantVelocityPredictor
from backend.pipeline.predict.kalman import KalmanPredictor
from backend.pipeline.predict.last_pose import LastPosePredictor
from backend.pipeline.predict.lstm import LstmPredictor
from backend.pipeline.predict.oracle import OraclePredictor, TruePose
from backend.pipeline.predict.predictor import Predictor

__all__ = ["Predictor", "TruePose", "make_predictor"]


def make_predictor(config: PredictorConfig, truth: TruePose) -> Predictor:
    """The predictor that ``config`` describes; only the oracle is given ``truth``."""
    match config:
        case ConstantVelocity():
            return ConstantVelocityPredictor(config)
        case Kalman():
            return KalmanPredictor(config)
        case Lstm():
            return LstmPredictor()
        case LastPose():
            return LastPosePredictor()
        case Oracle():
            return OraclePredictor(truth)
