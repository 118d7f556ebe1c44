"""Whether a trial can begin: nothing may touch the arm at home, nor be driven into the robot's base."""

import numpy as np

from backend.objects.description import ObjectDescription
from backend.pose import Array, Pose, inverse
from backend.tasks.prism import Prism, clear_of_spheres
from backend.tasks.setup import TrialSetup

ARM_CLEARANCE_M = 0.01
COLUMN_CLEARANCE_M = 0.005
COLUMN_REACH_M, COLUMN_HEIGHT_M = 0.05, 0.3
"""Spheres centred this close to the vertical through the base, and no higher, are base and shoulder."""
PATH_SAMPLES = 41


def can_begin(setup: TrialSetup, target: ObjectDescription, arm_spheres_world: Array) -> bool:
    """Whether tray, object and slab are clear of the arm at home, and the belt's whole way of its base."""
    solids = list(cargo(setup, target, setup.motion.pose_at(0.0)))
    if setup.slab is not None:
        solids.append(Prism.of_box(setup.slab.size_m, setup.slab.T_world_box))
    if not all(clear_of_spheres(solid, arm_spheres_world, ARM_CLEARANCE_M) for solid in solids):
        return False
    return _way_is_clear(setup, target, column(arm_spheres_world))


def column(arm_spheres_world: Array) -> Array:
    """(m, 4) those of the spheres that stay where they are: base and shoulder."""
    x, y, z, _ = arm_spheres_world.T
    return arm_spheres_world[(np.hypot(x, y) <= COLUMN_REACH_M) & (z <= COLUMN_HEIGHT_M)]


def cargo(setup: TrialSetup, target: ObjectDescription, T_world_tray: Pose) -> tuple[Prism, Prism]:
    """Tray and object, when the tray is there and the object has not moved on it."""
    T_world_box = T_world_tray @ Pose.of((0.0, 0.0, -setup.tray_size_m[2] / 2))
    tray = Prism.of_box(setup.tray_size_m, T_world_box)
    return tray, Prism.of_object(target, T_world_tray @ setup.T_tray_object)


def _way_is_clear(setup: TrialSetup, target: ObjectDescription, spheres_world: Array) -> bool:
    """Seen from the tray, which meets the spheres wherever the belt takes it past them."""
    times_s = np.linspace(0.0, setup.motion.duration_s, PATH_SAMPLES)
    Ts_tray_world = inverse(np.stack([setup.motion.pose_at(t_s).matrix for t_s in times_s]))
    centres = np.einsum("tij,nj->tni", Ts_tray_world[:, :3, :3], spheres_world[:, :3])
    centres += Ts_tray_world[:, None, :3, 3]
    radii = np.broadcast_to(spheres_world[:, 3:], (PATH_SAMPLES, len(spheres_world), 1))
    spheres_tray = np.concatenate([centres, radii], axis=-1).reshape(-1, 4)
    solids = cargo(setup, target, Pose.identity())
    return all(clear_of_spheres(solid, spheres_tray, COLUMN_CLEARANCE_M) for solid in solids)
