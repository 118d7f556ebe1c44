"""PANELS: everything beside the scene, in the order it stands."""

from app.ui.panels.crash import CrashPanel
from app.ui.panels.panel import Panel, View
from app.ui.panels.playback import PlaybackPanel
from app.ui.panels.ranking import RankingPanel
from app.ui.panels.scenario import ScenarioPanel
from app.ui.panels.signals import SignalsPanel
from app.ui.panels.trial import TrialPanel

CONTROL_PANELS: tuple[type[Panel], ...] = (CrashPanel, PlaybackPanel, ScenarioPanel)
"""On the right: what can be set."""
STATUS_PANELS: tuple[tuple[str, tuple[type[Panel], ...]], ...] = (
    ("Trial", (TrialPanel, SignalsPanel)),
    ("Grasps", (RankingPanel,)),
)
"""On the left, tab by tab: what is happening."""
PANELS = (*(panel for _, panels in STATUS_PANELS for panel in panels), *CONTROL_PANELS)

__all__ = ["CONTROL_PANELS", "PANELS", "STATUS_PANELS", "Panel", "View"]
