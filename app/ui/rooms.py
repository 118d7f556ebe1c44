"""Rooms of the page: which panel stands where, and the scene's floor and light."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import viser

from app.ui import palette
from app.ui.palette import Rgb
from app.ui.panels import CONTROL_PANELS, CONTROL_TABS, STATUS_TABS, TIMELINE_PANELS, VIEW_PANELS, Panel

AMBIENT = 0.9
LEFT_PX, RIGHT_PX = 270, 315
TIMELINE_PX = 645
MARGIN_PX = 10
FLOORS: dict[bool, tuple[Rgb, Rgb, Rgb]] = {
    False: (palette.FLOOR, palette.FLOOR_CELL, palette.FLOOR_SECTION),
    True: (palette.DARK_FLOOR, palette.DARK_FLOOR_CELL, palette.DARK_FLOOR_SECTION),
}
"""Plane, cells and sections, by whether it is dark."""

Maker = Callable[[type[Panel]], Panel]


def light(scene: viser.SceneApi, low_fx: bool) -> None:
    """Lights, and a floor below them."""
    scene.configure_default_lights(True, cast_shadow=not low_fx)
    if low_fx:
        scene.configure_environment_map(None)
        scene.add_light_ambient("/light", intensity=AMBIENT)
    scene.world_axes.visible = False
    lay_floor(scene, dark=False)


def lay_floor(scene: viser.SceneApi, dark: bool) -> None:
    """The grid on the floor; laid in one browser's own scene it hides the common one."""
    plane, cell, section = FLOORS[dark]
    scene.add_grid(
        "/floor",
        6.0,
        6.0,
        cell_size=0.1,
        cell_color=cell,
        section_size=0.5,
        section_color=section,
        plane_color=plane,
        plane_opacity=1.0,
        fade_distance=5.0,
        fade_strength=1.5,
        fade_from="origin",
        position=(0.0, 0.0, -0.001),
    )


def set_theme(gui: viser.GuiApi, dark: bool) -> None:
    """Of every browser, or of one."""
    gui.configure_theme(
        brand_color=palette.LINK if dark else palette.BRAND, show_logo=False, show_share_button=False, dark_mode=dark
    )


def furnish(gui: viser.GuiApi, make: Maker, add_view_tab: Callable[[], None]) -> list[Panel]:
    """Status on the left, controls on the right, the timeline below the scene."""
    set_theme(gui, dark=False)
    panels: list[Panel] = []

    def make_all(kinds: Iterable[type[Panel]]) -> None:
        panels.extend(make(kind) for kind in kinds)

    left = gui.add_panel()
    left.dock_left()
    left.set_width(LEFT_PX)
    for title, kinds in STATUS_TABS:
        with left.add_tab(title):
            make_all(kinds)
    gui.main_panel.dock_right()
    gui.main_panel.set_width(RIGHT_PX)
    make_all(CONTROL_PANELS)
    tabs = gui.add_tab_group()
    for title, kinds in CONTROL_TABS:
        with tabs.add_tab(title):
            make_all(kinds)
    with tabs.add_tab("View"):
        add_view_tab()
        make_all(VIEW_PANELS)
    below = gui.add_panel()
    with below.add_tab("Timeline"):
        make_all(TIMELINE_PANELS)
    below.float(x=MARGIN_PX, y=-MARGIN_PX, width=TIMELINE_PX)
    return panels
