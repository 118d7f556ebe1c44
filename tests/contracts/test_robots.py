"""What every listed robot must satisfy."""

import itertools
import math
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import trimesh

from backend.errors import MissingResourceError, NotFoundError
from backend.kinematics.kinematics import load_kinematics
from backend.pose import Array, Pose
from backend.robots import ROBOTS
from backend.robots.looks import open_hand
from backend.robots.models import RobotModel, load_model
from backend.robots.sources import SOURCES, packages_root, source_files
from backend.sim.bullet import STEP_S, Bullet, GripperDrive, HandAlone, Robot

DOWN = Pose.from_xyz_rpy((0.0, 0.0, 0.025), (math.pi, 0.0, 0.0))
"""Hand above the origin, fingers pointing down, pads around a 5 cm box on the floor."""


@pytest.fixture(params=sorted(ROBOTS))
def model(request: pytest.FixtureRequest) -> RobotModel:
    return load_model(request.param)


def test_every_robot_has_a_source():
    assert set(SOURCES) == set(ROBOTS)
    assert all(name == robot.name for name, robot in ROBOTS.items())


def test_every_joint_has_limits_and_home_is_within_them(model: RobotModel):
    robot = model.description
    lower, home, upper = (np.array(v) for v in (robot.joint_lower_rad, robot.home_rad, robot.joint_upper_rad))
    assert len(lower) == len(upper) == len(home) == len(robot.joint_effort_nm) == robot.dof
    assert (lower < home).all() and (home < upper).all()
    assert set(robot.profiles) == {"paper", "datasheet"}
    for profile in robot.profiles.values():
        assert len(profile.velocity_rps) == len(profile.acceleration_rps2) == robot.dof
        assert min(profile.velocity_rps) > 0.0 and min(profile.acceleration_rps2) > 0.0
        assert profile.source


def test_the_paper_profile_is_never_faster_than_the_data_sheet(model: RobotModel):
    profiles = model.description.profiles
    assert (np.array(profiles["paper"].velocity_rps) <= profiles["datasheet"].velocity_rps).all()


def test_names_of_joints_and_links_exist_in_every_file(model: RobotModel):
    gripper = model.description.gripper
    fingers = {gripper.master_joint, *(c.joint for c in (*gripper.gears, *gripper.followers))}
    for urdf in (model.collision_urdf, model.visual_urdf):
        names = _names(urdf)
        assert names >= {*model.description.arm_joints, *fingers, *gripper.hand_links, *gripper.finger_links}
        assert names >= {*itertools.chain(*model.description.allowed_self_contacts), *model.spheres}
    assert _names(model.hand_urdf) >= {*fingers, *gripper.hand_links}
    assert not _names(model.hand_urdf) & set(model.description.arm_joints)


def test_every_link_has_mass_and_every_mesh_exists(model: RobotModel):
    for urdf in (model.collision_urdf, model.visual_urdf, model.hand_urdf):
        robot = ET.parse(urdf).getroot()
        for link in robot.findall("link"):
            mass = link.find("inertial/mass")
            assert mass is not None and 0.0 < float(mass.get("value", "0")) < 20.0, link.get("name")
        for mesh in robot.iter("mesh"):
            assert (urdf.parent / mesh.get("filename", "")).is_file()


def test_spheres_cover_the_meshes(model: RobotModel):
    robot = ET.parse(model.visual_urdf).getroot()
    covered = 0
    for link in robot.findall("link"):
        for mesh in link.iter("mesh"):
            points = _surface(model.visual_urdf.parent / mesh.get("filename", ""))
            spheres = model.spheres[str(link.get("name"))]
            outside = np.linalg.norm(points[:, None] - spheres[None, :, :3], axis=2) - spheres[:, 3]
            assert outside.min(axis=1).max() < 1.5e-3, link.get("name")
            covered += 1
    assert covered >= len(model.spheres)


def test_spheres_do_not_bulge(model: RobotModel):
    robot = ET.parse(model.collision_urdf).getroot()
    for link in robot.findall("link"):
        hulls = [_surface(model.collision_urdf.parent / m.get("filename", "")) for m in link.iter("mesh")]
        if not hulls:
            continue
        vertices = np.concatenate(hulls)
        spheres = model.spheres[str(link.get("name"))]
        low, high = vertices.min(axis=0) - 0.03, vertices.max(axis=0) + 0.03
        assert (spheres[:, :3] - spheres[:, 3:] > low).all() and (spheres[:, :3] + spheres[:, 3:] < high).all()


def test_home_is_free_of_self_contacts(model: RobotModel):
    with Bullet() as bullet:
        robot = bullet.add_robot(model, np.array(model.description.home_rad), 0.0)
        assert robot.self_contacts() == set()


def test_a_folded_arm_is_found_to_touch_itself(model: RobotModel):
    rng = np.random.default_rng(0)
    lower, upper = (np.array(v) for v in (model.description.joint_lower_rad, model.description.joint_upper_rad))
    with Bullet() as bullet:
        robot = bullet.add_robot(model, np.array(model.description.home_rad), 0.0)
        found = 0
        for q in rng.uniform(lower, upper, size=(160, model.description.dof)):
            robot.reset(q, 0.0)
            found += bool(robot.self_contacts())
    assert 3 <= found <= 150


def test_the_hand_alone_lifts_a_box_and_holds_it(model: RobotModel):
    with Bullet() as bullet:
        bullet.add_floor()
        box = bullet.add_box((0.05, 0.05, 0.05), Pose.of((0.0, 0.0, 0.025)), mass_kg=0.2, friction=0.7)
        hand = bullet.add_hand(model, DOWN)
        drive = GripperDrive(model.description.gripper)
        drive.close()
        _carry(bullet, hand, drive, 0.0, 0.0, 1.0)
        gripped = _seen_from_tcp(bullet, hand, box)
        _carry(bullet, hand, drive, 0.0, 0.2, 0.8)
        _carry(bullet, hand, drive, 0.2, 0.2, 2.0)
        slip_m = np.linalg.norm(_seen_from_tcp(bullet, hand, box) - gripped)
        assert bullet.pose(box).xyz_m[2] > 0.2
        assert slip_m < 1e-3


def test_the_whole_arm_lifts_a_box_and_holds_it(model: RobotModel):
    kinematics = load_kinematics(model.description.name)
    Ts_world_tcp = np.array([(Pose.of((0.35, 0.1, z)) @ DOWN).matrix for z in np.linspace(0.0, 0.2, 193)])
    home = np.array(model.description.home_rad)
    ways = [kinematics.follow(Ts_world_tcp, q) for q in kinematics.ik_branches(Ts_world_tcp[0], home)]
    way = next(way for way in ways if way is not None)
    with Bullet() as bullet:
        bullet.add_floor()
        box = bullet.add_box((0.05, 0.05, 0.05), Pose.of((0.35, 0.1, 0.025)), mass_kg=0.2, friction=0.7)
        robot = bullet.add_robot(model, way[0], model.description.gripper.open_rad)
        drive = GripperDrive(model.description.gripper)
        drive.close()
        _follow(bullet, robot, drive, np.repeat(way[:1], 240, axis=0))
        gripped = _seen_from_tcp(bullet, robot, box)
        _follow(bullet, robot, drive, way)
        _follow(bullet, robot, drive, np.repeat(way[-1:], 480, axis=0))
        assert bullet.pose(box).xyz_m[2] > 0.2
        assert np.linalg.norm(_seen_from_tcp(bullet, robot, box) - gripped) < 1e-3


def test_an_opened_hand_lets_go(model: RobotModel):
    with Bullet() as bullet:
        bullet.add_floor()
        box = bullet.add_box((0.05, 0.05, 0.05), Pose.of((0.0, 0.0, 0.025)), mass_kg=0.2, friction=0.7)
        hand = bullet.add_hand(model, DOWN)
        drive = GripperDrive(model.description.gripper)
        drive.close()
        _carry(bullet, hand, drive, 0.0, 0.0, 1.0)
        _carry(bullet, hand, drive, 0.0, 0.1, 0.5)
        drive.open()
        _carry(bullet, hand, drive, 0.1, 0.1, 1.0)
        assert bullet.pose(box).xyz_m[2] < 0.04


def test_hand_alone_and_whole_arm_agree_on_the_hand(model: RobotModel):
    with Bullet() as bullet:
        robot = bullet.add_robot(model, np.array(model.description.home_rad), 0.0)
        hand = bullet.add_hand(model, robot.tcp())
        for rad in (0.0, 0.3, 0.6):
            robot.reset_fingers(rad)
            hand.reset(robot.tcp(), rad)
            for link in model.description.gripper.hand_links:
                assert np.allclose(robot.link_pose(link).matrix, hand.link_pose(link).matrix, atol=1e-5), link


def test_fingers_close_along_y_and_point_along_z(model: RobotModel):
    with Bullet() as bullet:
        hand = bullet.add_hand(model, Pose.identity())
        tips = {}
        for rad in (model.description.gripper.open_rad, 0.7):
            hand.reset(Pose.identity(), rad)
            links = model.description.gripper.finger_links
            tips[rad] = np.array([hand.link_pose(link).xyz_m for link in links])
    opened, closed = tips.values()
    assert (np.abs(closed[:, 1]) <= np.abs(opened[:, 1]) + 1e-3).all()
    assert np.abs(opened[:, 0]).max() < 0.01
    assert opened[:, 1].min() < -0.02 and opened[:, 1].max() > 0.02
    assert opened[:, 2].mean() < 0.0


def test_the_arm_follows_its_reference(model: RobotModel):
    home = np.array(model.description.home_rad)
    speed = np.array(model.description.profiles["paper"].velocity_rps)
    with Bullet() as bullet:
        robot = bullet.add_robot(model, home, 0.0)
        worst_rad = 0.0
        for k in range(360):
            q, qd = _swing(home, speed, k * STEP_S)
            robot.command(q.tolist(), qd.tolist(), model.description.gripper.open_rad)
            bullet.step()
            worst_rad = max(worst_rad, np.abs(robot.q() - _swing(home, speed, (k + 1) * STEP_S)[0]).max())
    assert worst_rad < 1e-3


def test_an_unknown_robot_names_the_known_ones():
    with pytest.raises(NotFoundError, match=r"no robot named 'micro'. Available: mico, ur5_robotiq. .*mico"):
        load_model("micro")


def test_missing_descriptions_name_the_install_line(tmp_path: Path):
    with pytest.raises(MissingResourceError, match=r"pip install rtb-data==1\.1\.0"):
        source_files(SOURCES["mico"], tmp_path)


def test_a_changed_source_makes_a_new_model(monkeypatch: pytest.MonkeyPatch):
    from backend.robots import models

    def fingerprint() -> str:
        return models._fingerprint(ROBOTS["mico"], SOURCES["mico"], packages_root())  # pyright: ignore[reportPrivateUsage]

    before = fingerprint()
    assert before == fingerprint()
    monkeypatch.setattr(models, "MAKERS", models.MAKERS[1:])
    assert fingerprint() != before


def test_a_cached_model_needs_no_mesh_library():
    load_model("mico")
    code = "import sys; from backend.robots.models import load_model; load_model('mico'); print(*sys.modules)"
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert not {"trimesh", "xacrodoc", "scipy"} & set(done.stdout.split())


def test_the_cache_follows_the_users_setting(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    from backend.files import cache_folder

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "dynamic-grasping"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder() == Path(os.path.expanduser("~")) / ".cache" / "dynamic-grasping"


def _names(urdf: Path) -> set[str]:
    robot = ET.parse(urdf).getroot()
    return {str(element.get("name")) for tag in ("link", "joint") for element in robot.findall(tag)}


def _surface(path: Path) -> Array:
    mesh = trimesh.load(path, force="mesh")
    assert isinstance(mesh, trimesh.Trimesh)
    return np.asarray(trimesh.sample.sample_surface(mesh, 1500, seed=7)[0], dtype=np.float64)


def _carry(bullet: Bullet, hand: HandAlone, drive: GripperDrive, from_m: float, to_m: float, within_s: float):
    steps = round(within_s / STEP_S)
    for k in range(steps):
        hand.move_to(Pose.of((0.0, 0.0, from_m + (to_m - from_m) * (k + 1) / steps)) @ DOWN)
        hand.command_gripper(drive.update(STEP_S))
        bullet.step()


def _follow(bullet: Bullet, robot: Robot, drive: GripperDrive, way: Array):
    speeds: Array = np.asarray(np.gradient(way, STEP_S, axis=0), dtype=np.float64)
    for q, qd in zip(way, speeds, strict=True):
        robot.command(q.tolist(), qd.tolist(), drive.update(STEP_S))
        bullet.step()


def _seen_from_tcp(bullet: Bullet, hand: HandAlone | Robot, body: int) -> Array:
    return (hand.tcp().inverse() @ bullet.pose(body)).xyz_m


def _swing(home: Array, speed: Array, t_s: float) -> tuple[Array, Array]:
    """A smooth motion from rest whose largest speed is ``speed``."""
    signs = np.where(np.arange(len(home)) % 2, -1.0, 1.0)
    rate = 3.0
    return home + signs * speed / rate * (1 - math.cos(rate * t_s)), signs * speed * math.sin(rate * t_s)


def test_the_drawn_open_hand_has_its_opening_between_the_pads(model: RobotModel):
    hand = open_hand(model.description.name).vertices
    tips = hand[hand[:, 2] > hand[:, 2].max() - 0.03]
    left, right = tips[tips[:, 1] > 0.0], tips[tips[:, 1] < 0.0]
    gap_m = left[:, 1].min() - right[:, 1].max()
    assert gap_m == pytest.approx(model.description.gripper.opening_m, abs=1e-3)
    assert left[:, 1].max() == pytest.approx(-right[:, 1].min(), abs=1e-3)
