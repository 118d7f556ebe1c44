"""LinkTree against pinocchio, joint by joint, and on broken files."""

import importlib
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from backend.errors import InvalidInputError, NotFoundError
from backend.kinematics.urdf import LinkTree
from backend.robots import ROBOTS
from backend.robots.models import load_model

pin: Any = importlib.import_module("pinocchio")


@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_every_link_stands_where_pinocchio_says(robot: str):
    path = load_model(robot).collision_urdf
    tree = LinkTree.from_urdf(path)
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = pin.neutral(model)
        joints_rad: dict[str, float] = {}
        for name, joint in list(zip(model.names, model.joints, strict=True))[1:]:
            angle = rng.uniform(-1.5, 1.5)
            joints_rad[name] = angle
            q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
        pin.framesForwardKinematics(model, data, q)
        for link, T in tree.link_poses(joints_rad).items():
            expected = data.oMf[model.getFrameId(link, pin.FrameType.BODY)].homogeneous
            assert np.allclose(T, expected, atol=1e-9), link


def test_a_file_with_two_roots_is_refused(tmp_path: Path):
    path = tmp_path / "two.urdf"
    path.write_text('<robot name="x"><link name="a"/><link name="b"/></robot>')
    with pytest.raises(InvalidInputError, match=r"two\.urdf: a robot has one root link, this one has \['a', 'b'\]"):
        LinkTree.from_urdf(path)


def test_an_unknown_joint_is_named_with_those_that_exist():
    tree = LinkTree.from_urdf(load_model("mico").collision_urdf)
    with pytest.raises(NotFoundError, match="no joint named 'elbow'"):
        tree.joint("elbow")


def test_drawing_from_a_link_tree_needs_no_compiler():
    code = "import sys, backend.kinematics.urdf; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
