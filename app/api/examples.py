"""Examples of commands and views, as the API's description shows them."""

from fastapi.openapi.models import Example

OWN_FILE = """\
title = "Mine"
robot = "mico"
object = "cube"
method = "ours_rm"
[task]
kind = "linear"
speed_mps = 0.03
distance_min_m = 0.15
distance_max_m = 0.4
"""


def _example(summary: str, **fields: object) -> Example:
    return {"summary": summary, "value": fields}


COMMANDS: dict[str, Example] = {
    "pause": _example("Pause; false plays", kind="set_paused", paused=True),
    "step": _example("Pause, and one tick on", kind="step_once"),
    "speed": _example("Twice real time; null is as fast as it goes", kind="set_speed", speed=2.0),
    "restart": _example("Another scenario, as its file has it", kind="restart", scenario="mico_circular", seed=7),
    "settings": _example(
        "The same with other settings",
        kind="restart",
        scenario="ur5_linear",
        seed=3,
        overrides={"object": "cube", "task.speed_mps": 0.04, "method.predictor.kind": "lstm"},
    ),
    "file": _example(
        "A scenario file of your own",
        kind="restart",
        scenario="mine",
        file=OWN_FILE,
    ),
    "belt": _example(
        "The belt of the running trial, backwards", kind="apply_event", event={"kind": "set_belt_rate", "rate": -1.0}
    ),
    "obstacle": _example(
        "An obstacle of the running trial",
        kind="apply_event",
        event={"kind": "move_obstacle", "index": 0, "x_m": 0.5, "y_m": -0.2},
    ),
    "new obstacle": _example(
        "One more obstacle in the running trial; `remove_obstacle` with its `index` takes it away",
        kind="apply_event",
        event={"kind": "add_obstacle", "object": "power_drill", "x_m": 0.6, "y_m": 0.4},
    ),
    "slab": _example(
        "A slab 40 cm above the belt of the running trial; null takes it away",
        kind="apply_event",
        event={"kind": "set_slab", "height_m": 0.4},
    ),
    "look back": _example("Show an earlier moment; null is the newest", kind="look_back", t_s=2.5),
    "go on": _example("Play on from the moment shown", kind="go_on"),
}

VIEWS: dict[str, Example] = {
    "auto next": _example("Do not begin the next trial by itself", auto_next=False),
    "colours": _example("Colour the small hands by reachability", grasps_by="Reachability"),
    "card": _example("Show the card of a grasp; null shows none", grasp=12),
    "layers": _example("Show every layer of the scene but two; [] shows all", hidden=["All grasps", "Hand trail"]),
    "reach": _example("Slice through the reach at 30 cm", hidden=[], reach_of="From the side", reach_height_m=0.3),
}
