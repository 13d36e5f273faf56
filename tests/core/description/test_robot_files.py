"""Finding robots and meshes, and refusing what is not there.

Where the robots of example-robot-data are looked for.
"""

from pathlib import Path

import pytest

from station.core.description import robot_files
from station.core.description.robot_files import (
    data_directories,
    fetched_directory,
    is_complete,
    known_robots,
    load_robot_files,
)
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError

SMALL = '<robot name="r"><link name="base"/></robot>'


def write_urdf(directory: Path, text: str, name: str = "r.urdf") -> str:
    path = directory / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_panda_is_found_with_its_srdf() -> None:
    description = load_robot_files("example-robot-data:panda")
    assert description.urdf_path.name == "panda.urdf"
    assert description.srdf_path is not None
    assert description.srdf_path.name == "panda.srdf"


@pytest.mark.parametrize("name", ["ur5", "ur5_robot", "kinova", "talos_left_arm"])
def test_robots_are_known_by_their_file_and_short_names(name: str) -> None:
    assert name in known_robots()


def test_srdf_of_a_partial_robot_is_that_of_the_whole() -> None:
    description = load_robot_files("example-robot-data:talos_left_arm")
    assert description.srdf_path is not None
    assert description.srdf_path.name == "talos.srdf"


def test_unknown_robot_is_refused_with_the_known_names() -> None:
    with pytest.raises(RobotDescriptionError, match="no robot 'pandaa'") as caught:
        load_robot_files("example-robot-data:pandaa")
    assert "panda" in caught.value.remedy
    assert "ur5" in caught.value.remedy


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not XML"),
        ("<robot", "not XML"),
        ("<sdf/>", "root element is <sdf>"),
        ("x" * 5_000_000, "5000000 bytes"),
    ],
)
def test_file_that_is_no_urdf_is_refused(
    tmp_path: Path, text: str, reason: str
) -> None:
    with pytest.raises(RobotDescriptionError, match=reason):
        load_robot_files(write_urdf(tmp_path, text))


def test_missing_file_is_refused_with_its_path(tmp_path: Path) -> None:
    with pytest.raises(
        RobotDescriptionError, match=r"none\.urdf cannot be read: No such"
    ):
        load_robot_files(str(tmp_path / "none.urdf"))


def test_mesh_of_package_uri_is_found_above_the_urdf(tmp_path: Path) -> None:
    urdf_directory = tmp_path / "my_robot" / "urdf"
    urdf_directory.mkdir(parents=True)
    mesh = tmp_path / "my_robot" / "a mesh.stl"
    mesh.touch()
    description = load_robot_files(write_urdf(urdf_directory, SMALL))
    assert description.resolve_mesh("package://my_robot/a%20mesh.stl") == mesh
    assert description.resolve_mesh("../a mesh.stl") == mesh
    assert description.resolve_mesh(f"file://{tmp_path}/my_robot/a%20mesh.stl") == mesh


def test_mesh_is_found_through_the_ros_package_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "elsewhere"
    (elsewhere / "pkg").mkdir(parents=True)
    (elsewhere / "pkg" / "m.stl").touch()
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{elsewhere}")
    description = load_robot_files(write_urdf(tmp_path, SMALL))
    assert description.resolve_mesh("package://pkg/m.stl").name == "m.stl"


@pytest.mark.parametrize("uri", ["package://pkg/m.stl", "m.stl", "http://x/m.stl"])
def test_missing_mesh_is_refused_with_its_uri(tmp_path: Path, uri: str) -> None:
    description = load_robot_files(write_urdf(tmp_path, SMALL))
    with pytest.raises(RobotDescriptionError, match=rf"The mesh '{uri}'"):
        description.resolve_mesh(uri)


def test_xacro_file_is_refused_with_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(RobotDescriptionError, match="is a xacro file") as caught:
        load_robot_files(write_urdf(tmp_path, SMALL, "r.xacro"))
    assert "Run xacro" in caught.value.remedy


def test_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_bytes(b"\xff\xfe<robot/>")
    with pytest.raises(RobotDescriptionError, match="not a text in UTF-8"):
        load_robot_files(str(path))


def test_prefix_is_replaced_in_every_name() -> None:
    description = load_robot_files("example-robot-data:panda")
    left = parse_urdf(description.with_prefix("panda_", "left_").xml)
    assert left.root == "left_link0"
    assert not [n for n in (*left.links, *left.joints) if not n.startswith("left_")]
    mimic = left.joints["left_finger_joint2"].mimic
    assert mimic is not None
    assert mimic.joint == "left_finger_joint1"


def test_installed_package_comes_before_what_was_fetched(tmp_path, monkeypatch):
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path))
    (tmp_path / "example-robot-data/robots").mkdir(parents=True)

    installed, fetched = data_directories()

    assert (installed / "robots/ur_description").is_dir()
    assert fetched == fetched_directory()
    assert is_complete()


def test_without_either_there_is_none(tmp_path, monkeypatch):
    monkeypatch.setenv("STATION_ROBOT_DATA", str(tmp_path))
    monkeypatch.setattr(robot_files, "_installed_directory", lambda: None)

    assert data_directories() == []
    assert not is_complete()


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"STATION_ROBOT_DATA": "/a"}, "/a"),
        ({"XDG_DATA_HOME": "/b"}, "/b/control-station"),
        ({}, "/home/me/.local/share/control-station"),
    ],
)
def test_fetched_robots_are_in_the_users_directory(monkeypatch, variables, expected):
    for name in ("STATION_ROBOT_DATA", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", "/home/me")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)

    assert fetched_directory() == Path(expected, "example-robot-data")
