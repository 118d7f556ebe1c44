"""PANELS: everything beside the scene, in the order it stands."""

from app.ui.panels.belt import BeltPanel
from app.ui.panels.crash import CrashPanel
from app.ui.panels.legend import LegendPanel
from app.ui.panels.method import MethodPanel
from app.ui.panels.obstacles import ObstaclesPanel
from app.ui.panels.panel import Panel, View
from app.ui.panels.playback import PlaybackPanel
from app.ui.panels.ranking import RankingPanel
from app.ui.panels.scenario import ScenarioPanel
from app.ui.panels.share import SharePanel
from app.ui.panels.signals import SignalsPanel
from app.ui.panels.task import TaskPanel
from app.ui.panels.timeline import TimelinePanel
from app.ui.panels.trial import TrialPanel

Panels = tuple[type[Panel], ...]

CONTROL_PANELS: Panels = (CrashPanel, PlaybackPanel)
"""On the right, always in sight."""
CONTROL_TABS: tuple[tuple[str, Panels], ...] = (
    ("Scenario", (ScenarioPanel, BeltPanel, ObstaclesPanel, TaskPanel)),
    ("Method", (MethodPanel,)),
    ("Share", (SharePanel,)),
)
"""Below them, tab by tab: what can be set."""
VIEW_PANELS: Panels = (LegendPanel,)
"""In a last tab beside those, below what is each browser's own."""
STATUS_TABS: tuple[tuple[str, Panels], ...] = (
    ("Trial", (TrialPanel,)),
    ("Grasps", (RankingPanel,)),
    ("Signals", (SignalsPanel,)),
)
"""On the left, tab by tab: what is happening."""
TIMELINE_PANELS: Panels = (TimelinePanel,)
"""Below the scene."""
PANELS: Panels = (
    *(panel for _, panels in (*STATUS_TABS, *CONTROL_TABS) for panel in panels),
    *CONTROL_PANELS,
    *VIEW_PANELS,
    *TIMELINE_PANELS,
)

__all__ = ["CONTROL_PANELS", "CONTROL_TABS", "PANELS", "STATUS_TABS", "TIMELINE_PANELS", "VIEW_PANELS", "Panel", "View"]
