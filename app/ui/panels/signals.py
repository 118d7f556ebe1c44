"""Signals: how far the hand is from the object, over the trial."""

from __future__ import annotations

from collections import deque

import numpy as np
import viser
from viser import uplot

from app.ui.desk import Desk
from app.ui.palette import PLAN, TRAIL, css
from app.ui.panels.panel import View
from app.ui.progress import AutoNext
from app.ui.words import heading

SAMPLE_S = 0.2
LONGEST = 600
"""Samples that are kept: two minutes."""
CM_PER_M = 100.0
PLAIN = uplot.Series_Points(show=False)


class SignalsPanel:
    """One chart; a new trial empties it."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, auto_next: AutoNext) -> None:
        self._samples: deque[tuple[float, float, float, int]] = deque(maxlen=LONGEST)
        self._run: object = None
        gui.add_html(heading("Hand to object / object height, cm"))
        self._chart = gui.add_uplot(
            data=(np.zeros(1), np.zeros(1), np.zeros(1)),
            series=(
                uplot.Series(label="s"),
                uplot.Series(label="distance", stroke=css(PLAN), width=1.5, points=PLAIN),
                uplot.Series(label="height", stroke=css(TRAIL), width=1.5, points=PLAIN),
            ),
            scales={"x": uplot.Scale(time=False), "y": uplot.Scale(auto=True)},
            axes=(uplot.Axis(size=22, font="10px sans-serif"), uplot.Axis(size=30, font="10px sans-serif")),
            legend=uplot.Legend(show=False),
            cursor=uplot.Cursor(show=False),
            height=130,
        )

    def show(self, view: View) -> None:
        snapshot, started = view.live.snapshot, view.live.started
        if started is not self._run:
            self._run = started
            from_tick = started.restart.from_tick if started else 0
            while self._samples and self._samples[-1][3] >= from_tick:  # all, unless gone on from an earlier moment
                self._samples.pop()
        if snapshot is None or (self._samples and snapshot.t_s - self._samples[-1][0] < SAMPLE_S):
            return
        hand, target = snapshot.T_world_tcp.xyz_m, snapshot.T_world_object.xyz_m
        distance_m = float(np.linalg.norm(hand - target))
        self._samples.append((snapshot.t_s, CM_PER_M * distance_m, CM_PER_M * float(target[2]), snapshot.tick))
        t_s, distance, height, _ = np.array(self._samples).T
        self._chart.data = (t_s, distance, height)
