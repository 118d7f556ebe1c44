"""What thinking costs in simulated time: a fixed budget, the paper's constants, or the wall clock."""

from backend.scenario import TimingConfig

RANKING_S = 0.135
IK_CALL_S = 0.01
PLAN_S = 0.14
"""What the evaluation of the paper charged for ranking, for each IK call and for each motion plan."""

OVERRUN_MARGIN = 1.25


class ThinkTime:
    """Says, before a plan is made, when it will take effect."""

    def __init__(self, config: TimingConfig) -> None:
        self._config = config
        self._measured_s = config.budget_s

    def expected_s(self, ik_calls: int = 20) -> float:
        """Charge of a cycle that gets as far as a plan, after ``ik_calls`` IK calls; seconds."""
        match self._config.think:
            case "budget":
                return self._config.budget_s
            case "paper":
                return RANKING_S + IK_CALL_S * ik_calls + PLAN_S
            case "measured":
                return self._measured_s

    def refused_s(self, ik_calls: int) -> float:
        """Charge of a cycle that ended before a plan was asked for; seconds."""
        return RANKING_S + IK_CALL_S * ik_calls if self._config.think == "paper" else self.expected_s()

    def approach_s(self) -> float:
        """Charge of deciding on an approach (free in the paper's evaluation); seconds."""
        return 0.0 if self._config.think == "paper" else self.expected_s()

    def overran(self, wall_s: float) -> bool:
        """Learn what a cycle really took; True when that was longer than it had been given (``measured`` only)."""
        if self._config.think != "measured":
            return False
        given_s = self._measured_s
        self._measured_s = max(wall_s * OVERRUN_MARGIN, 0.9 * given_s)
        return wall_s > given_s
