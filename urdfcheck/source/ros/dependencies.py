"""What packages depend on, through others that are found and through well-known ones that ROS has released."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from urdfcheck.source.package.finder import Package, PackageFinder, has_dependency_entry, load_package

# The manifests of so many packages are read.
_MAX_MANIFESTS = 1_000
# What released packages depend on at run time, as far as launch files and models name it: rosdep installs it with them, and their
# manifests are rarely on the machine. In ROS 1 and in ROS 2, where both have the package.
_BROUGHT = {
    "fanuc_driver": "industrial_robot_client",
    "gazebo_plugins": "gazebo_ros",
    "gazebo_ros": "tf",
    "gazebo_ros2_control": "controller_manager gazebo_ros",
    "gazebo_ros_control": "controller_manager gazebo_ros",
    "gz_ros2_control": "controller_manager",
    "ign_ros2_control": "controller_manager",
    "joint_state_publisher_gui": "joint_state_publisher",
    "nav2_bringup": "navigation2 slam_toolbox",
    "navigation": "amcl fake_localization map_server move_base robot_pose_ekf",
    "realsense2_description": "xacro",
    "robot_state_publisher": "tf2_ros",
    "ros2_control": "controller_manager",
    "ros_control": "controller_manager",
    "rosbridge_suite": "rosapi rosbridge_library rosbridge_server",
    "slam_gmapping": "gmapping",
    "teleop_twist_joy": "joy",
    "tf": "tf2_ros",
    "ur_moveit_config": "ur_description xacro",
    "ur_robot_driver": "controller_manager robot_state_publisher ur_description",
    "ur_simulation_gz": "ign_ros2_control ros_gz_bridge ros_gz_sim rviz2 ur_description ur_moveit_config xacro",
    "urdf_launch": "joint_state_publisher joint_state_publisher_gui robot_state_publisher rviz2 xacro",
    "urdf_tutorial": "joint_state_publisher robot_state_publisher rviz urdf_launch xacro",
}
# Collections whose parts have another beginning than the name of the collection, and what the names of the parts begin with.
COLLECTIONS = {
    "gazebo": (),  # the key of the simulator alone, which rosdep installs without its packages for ROS
    "gazebo_ros_pkgs": ("gazebo_",),
    "ros_gz": ("ros_gz_", "ros_ign_"),
    "navigation2": ("nav2_",),
    "rtabmap_ros": ("rtabmap_",),
    "desktop": ("",),
    "desktop_full": ("",),
    "ros_base": ("",),
    "ros_core": ("",),
}


def collect_dependencies(finder: PackageFinder | None, names: Iterable[str]) -> set[str]:
    """Return the dependencies of these packages, as far as they are found or well known, and of those, and so on."""
    names = set(names)
    found = {name for package in _iter_packages(finder, names) for name in package.dependencies}
    return found | _collect_brought(names | found)


def has_part(collections: Iterable[str], name: str) -> bool:
    """Whether a package is by its name a part of one of these, if they are collections (``ros_gz_sim`` of ``ros_gz``)."""
    return name.startswith(tuple(begin for one in collections for begin in COLLECTIONS.get(one, (f"{one}_",))))


def find_dependent(package: Package, name: str, finder: PackageFinder) -> str | None:
    """Return the package whose manifest depends on another: this one, or one that it depends on; None if there is none."""
    if name in package.dependencies:
        return package.name
    below = _iter_packages(finder, package.dependencies)
    found = next((inner.name for inner in below if name in inner.dependencies), None)
    return found or next((one for one in sorted(package.dependencies) if name in _collect_brought([one])), None)


def needs(name: str, owner: Package, finder: PackageFinder | None) -> bool:
    """Whether another package depends on this one, so that this one cannot declare it: build tools refuse a cycle."""
    return owner.name in collect_dependencies(finder, [name])


def describe_declaration(owner: Package | None, name: str, finder: PackageFinder, *, shown: str = "") -> str:
    """Return the end of a repair after which a package uses another: that its manifest must declare that one, or cannot.

    Empty where it does already, and where there is no manifest. ``shown``: what the repair calls the other package.
    """
    if owner is None or name == owner.name or find_dependent(owner, name, finder) is not None:
        return ""
    if needs(name, owner, finder):
        return f" ({name} depends on {owner.name}, so package.xml cannot declare it)"
    return f", and declare {shown or name} in package.xml"


def find_dependent_in_project(name: str, finder: PackageFinder) -> str | None:
    """Return a package of the project whose manifest depends on another, for a file that is in no package."""
    packages = finder.list_workspace_packages()
    return next((own for own, folder in sorted(packages.items()) if has_dependency_entry(folder, name)), None)


def _collect_brought(names: Iterable[str]) -> set[str]:
    """Return what well-known released packages depend on, through others of them too."""
    left = [*names]
    brought: set[str] = set()
    while left:
        new = set(_BROUGHT.get(left.pop(), "").split()) - brought
        brought |= new
        left += sorted(new)
    return brought


def _iter_packages(finder: PackageFinder | None, names: Iterable[str]) -> Iterator[Package]:
    """Yield these packages, as far as they are found, and those that they depend on."""
    left = sorted(names)
    seen = set(left)
    for _ in range(_MAX_MANIFESTS):
        if not left or finder is None:
            return
        folder = finder.find(left.pop())
        package = None if folder is None or not finder.can_open(folder / "package.xml") else load_package(folder)
        if package is not None:
            left += sorted(package.dependencies - seen)
            seen |= package.dependencies
            yield package
