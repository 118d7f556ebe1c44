"""Where the robots' geometry comes from: the xacro sources of ``rtb-data``, compiled to plain URDF."""

from __future__ import annotations

import importlib.util
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from backend.errors import MissingResourceError

INSTALL = "pip install rtb-data==1.1.0"


@dataclass(frozen=True)
class RobotSource:
    """What to compile, and what of the result is not part of the robot."""

    xacro: str
    """Text of a xacro document; ``$(find package)`` finds the description packages of ``rtb-data``."""
    folders: tuple[str, ...]
    """Folders, seen from the description packages' root, whose files the document reads."""
    dropped_links: tuple[str, ...] = ()
    """Frames without geometry of their own that nothing here uses, or with geometry that is not there."""
    default_rgba: tuple[float, float, float, float] | None = None
    """Colour of meshes that bring none; None takes the URDF's."""


MICO = RobotSource(
    xacro="""<robot name="mico" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:include filename="$(find kinova_description)/urdf/m1n6s200_standalone.xacro"/>
</robot>""",
    folders=("kinova_description/urdf", "kinova_description/meshes"),
    default_rgba=(0.18, 0.18, 0.18, 1.0),
)

UR5_ROBOTIQ = RobotSource(
    xacro="""<robot name="ur5_robotiq" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:include filename="$(find ur_description)/urdf/ur5_robot.urdf.xacro"/>
  <xacro:include filename="$(find kortex_description)/grippers/robotiq_2f_85/urdf/robotiq_2f_85_macro.xacro"/>
  <xacro:include
      filename="$(find kortex_description)/grippers/robotiq_2f_85/urdf/robotiq_arg2f_85_model_macro.xacro"/>
  <xacro:robotiq_arg2f_85 parent="tool0" prefix=""/>
</robot>""",
    folders=(
        "ur_description/urdf",
        "ur_description/meshes/ur5",
        "kortex_description/grippers/robotiq_2f_85",
    ),
    dropped_links=("ee_link", "base", "tool_frame"),
)

SOURCES: dict[str, RobotSource] = {"mico": MICO, "ur5_robotiq": UR5_ROBOTIQ}


def packages_root() -> Path:
    """Folder of the description packages; raises ``MissingResourceError`` when ``rtb-data`` is not there."""
    spec = importlib.util.find_spec("rtbdata")
    root = Path(spec.origin).parent / "xacro" if spec and spec.origin else None
    if root is None or not root.is_dir():
        raise MissingResourceError(
            "The robot descriptions are missing: package rtb-data 1.1.0 (2.x no longer has them). "
            f"Install them with: {INSTALL}"
        )
    return root


def source_files(source: RobotSource, root: Path) -> list[Path]:
    """Every file the compilation may read, sorted; raises ``MissingResourceError`` for a missing folder."""
    files: list[Path] = []
    for folder in source.folders:
        if not (root / folder).is_dir():
            raise MissingResourceError(
                f"The robot descriptions in {root} lack {folder}. Install the version that has it: {INSTALL}"
            )
        files += [path for path in (root / folder).rglob("*") if path.is_file()]
    return sorted(files)


def compile_urdf(source: RobotSource, root: Path) -> ET.Element:
    """The compiled URDF, mesh paths absolute, without the dropped links."""
    from xacrodoc import XacroDoc, packages

    packages.update_package_cache({path.name: str(path) for path in root.iterdir() if path.is_dir()})
    robot = ET.fromstring(XacroDoc.from_string(source.xacro).to_urdf_string(use_protocols=False))
    for element in list(robot):
        child = element.find("child")
        gone = element.get("name") if element.tag == "link" else None
        if element.tag == "joint" and child is not None:
            gone = child.get("link")
        if element.tag not in ("link", "joint") or gone in source.dropped_links:
            robot.remove(element)
    for limit in robot.findall("joint[@type='continuous']/limit"):
        for bound in ("lower", "upper"):  # PyBullet would stop a continuous joint there
            limit.attrib.pop(bound, None)
    return robot
