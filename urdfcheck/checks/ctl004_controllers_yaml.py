"""CTL004 reports controller configurations that do not fit the model."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Edit, Finding, Fix, Located, Location, Rule, Severity
from urdfcheck.core.text import find_nearest_name, find_only_near_name, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.model.likeness.sibling_robots import PackageNames
from urdfcheck.model.motion.controllers import (
    AssociatedConfiguration,
    ParameterFile,
    can_offer_with_other_arguments,
    collect_command_interfaces,
    collect_interfaces,
    find_controller_configs,
    find_launched_configs,
    list_parameter_files,
)
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.repairs.edits import edit_content
from urdfcheck.model.repairs.number_text import keep_notation
from urdfcheck.model.use.controller_starts import is_left_unstarted
from urdfcheck.model.use.simulators import is_simulated_hardware
from urdfcheck.source.launch.built_files import find_template, is_git_ignored
from urdfcheck.source.load import read_xacro_source
from urdfcheck.source.package.file_kinds import is_xacro
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.package.similar_files import find_files_elsewhere, normalise_path
from urdfcheck.source.reach import FileReach
from urdfcheck.source.ros.controllers import Controller, GpioClaim
from urdfcheck.source.ros.yaml_files import find_yaml_error
from urdfcheck.source.text.xml import Element
from urdfcheck.source.text.yaml.values import YamlValue
from urdfcheck.source.uses_elsewhere import CONTAINER_FILE, find_other_includers, is_left_output, is_named_nowhere
from urdfcheck.source.xacro.usage import list_content_arguments
from urdfcheck.system.files import read_text_or_nothing

# Each suggestion compares all names.
MOST_HINTS = 100
# The folder of the packages of ROS, the same on each machine.
_DISTRIBUTIONS = "/opt/ros/"
# A path into an installed package.
_INSTALLED = re.compile(r"/share/([\w-]+)/(.+)$")
# A workspace and what is in it.
_WORKSPACE = re.compile(r"(/.+?)/(?:install|devel|src|share)/")
# The folders of files that describe a container.
_CONTAINER_FOLDERS = ("", "docker", ".docker", ".devcontainer")
_OUTSIDE = "drops the control plugin outside that container: no controller manager starts"
_OF_GAZEBO = re.compile(r"gazebo|gz_|ign_", re.IGNORECASE)
_BARE = "; and no launch file here is seen to run xacro on this .urdf: without it the plugin gets `$(find …)` as it is typed"
# What reads a controller of each form.
_READERS = {"ros1": ("ros_control", "gazebo"), "ros2": ("ros2_control", "gazebo"), "moveit": ()}
OTHER_DRIVES = frozenset({"mecanum_drive_controller/MecanumDriveController", "tricycle_controller/TricycleController"})


def check(subject: Model | LaunchContext, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    if isinstance(subject, LaunchContext):
        model = subject.model
        configs = () if model is None else find_launched_configs(subject.launch, model)
    else:
        model, configs = subject, find_controller_configs(subject)
        yield from _check_parameter_files(subject, rule)
    if model is None or not configs:
        return
    elsewhere = PackageNames(model)
    named = next((config.configuration.path for config in configs if config.named_at is not None), None)
    for config in configs:
        yield from _check_unknown_joints(model, rule, config, elsewhere=elsewhere, named=named)
        if config.named_at is not None:
            yield from _check_command_interfaces(model, rule, config)
        yield from _check_gpios(model, rule, config)
    for config in configs:
        if named is not None and _is_left_over(model, config):
            continue
        for controller in config.configuration.controllers:
            # Without a reference to the file, wheels of this name on another robot may be meant.
            others = elsewhere if config.named_at is None else None
            if controller.type.startswith("diff_drive_controller/"):
                found = _check_wheel_geometry(model, rule, controller, elsewhere=others, rel_tol=rel_tol)
            elif controller.type in OTHER_DRIVES:
                found = _check_other_drive(model, rule, controller, elsewhere=others, rel_tol=rel_tol)
            else:
                continue
            yield from (_mention_other_users(model, config, finding) for finding in found)


def _check_parameter_files(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report parameter files of the model's own plugins that are missing, broken or on this machine only."""
    for parameters in list_parameter_files(model):
        shown = format_path(parameters.path) if parameters.path is not None else parameters.text
        problem = None if parameters.path is None else find_yaml_error(parameters.path, model.source.finder)
        if problem is not None:
            broken = Location("yaml", problem.span)
            yield rule.finding("broken", at=broken, related=[parameters.element], reason=str(problem))
        made = _describe_maker(model, parameters) if parameters.missing else None
        if made is not None:
            yield rule.finding("made", at=parameters.element, severity=Severity.INFO, path=parameters.text, **made)
        elif parameters.missing:
            like = [
                format_path(path)
                for path in find_files_elsewhere(parameters.text, model.source.path, model.source.finder)
            ]
            is_bare = _is_read_as_it_is(model)
            yield rule.finding(
                "missing",
                at=parameters.element,
                path=parameters.text,
                bare=_BARE if is_bare else "",
                near=f" ({join_names(like, 2)} {'has' if len(like) == 1 else 'have'} this name)" if like else "",
                also="; and let the launch file run xacro on this file" if is_bare else "",
            )
        elif _is_of_one_machine(parameters) and not _names_other_simulator(model):
            portable = _find_portable_path(model, parameters)
            package, below = portable or _read_package_in_path(model, parameters.text) or ("package", "config/…")
            is_certain = model.source.is_xacro and portable is not None
            text = f"$(find {package})/{below}"
            is_shared = _is_in_container(model, parameters.text)
            yield rule.finding(
                "machine",
                at=parameters.element,
                severity=Severity.INFO if is_shared or is_left_output(model.source) else Severity.WARNING,
                consequences={"gazebo": _OUTSIDE} if is_shared else None,
                edits=edit_content(parameters.element, text, model.source.files) if is_certain else (),
                how=_describe_how(model, parameters.element),
                also=_describe_absence(model, package, below) if parameters.path is None else "",
                package=package,
                below=below,
                path=parameters.text,
                owner="container" if is_shared else "machine",
                found=f" (here {shown})" if parameters.path is not None else "",
            )


def _describe_maker(model: Model, parameters: ParameterFile) -> dict[str, Any] | None:
    """Say why a missing file is none of the model's: the launch files that start it pass another, or the build makes it."""
    from urdfcheck.model.use.started_variants import find_passing_starter  # few robots name a file that is missing

    names = list_content_arguments(model.source.trees, parameters.element)
    starter = find_passing_starter(model.source, names) if names else None
    if starter is not None:
        given = (
            f"the default of argument {names[0]}" if len(names) == 1 else f"made of the arguments {join_names(names)}"
        )
        return {
            "why": f"it is {given}, and {format_path(starter)} passes another value",
            "repair": "give the argument no default, or one that exists, if xacro may run without that launch file",
        }
    path, finder = normalise_path(Path(parameters.text)), model.source.finder
    package = finder.find_package_of(path)
    template = None if package is None else find_template(path, package.path)
    if template is not None and finder.can_open(template):
        return {
            "why": f"it is made from {format_path(template)}",
            "repair": f"build the package, which makes {path.name}",
        }
    if package is not None and is_git_ignored(path, FileReach.from_paths([package.path], [])):
        return {"why": "git ignores it, so a program makes it", "repair": f"make {path.name} before the launch"}
    return None


def _is_of_one_machine(parameters: ParameterFile) -> bool:
    is_absolute = parameters.text.startswith("/") and not parameters.text.startswith(_DISTRIBUTIONS)
    return parameters.literal and is_absolute


def _is_read_as_it_is(model: Model) -> bool:
    """Whether a file is not named as a xacro, and no launch file around it names it and xacro: nothing expands `$(find …)`."""
    from urdfcheck.source.launch.model_launches import may_run_xacro  # few robots name a file that is missing

    return not is_xacro(model.source.path) and not may_run_xacro(model.source.path, model.source.finder)


def _describe_how(model: Model, element: Element) -> str:
    """Say what must be done before ``$(find …)`` can be written."""
    if model.source.is_xacro:
        return ""
    if not model.source.is_output_of_xacro:
        return "make the model a xacro and "
    lacking = _find_source_without(model, element)
    if lacking is not None:
        return f"add the plugin to {lacking}, which has none and would lose it when it is expanded again, and there "
    return "expand the xacro when it is launched instead of keeping its output, and there "


def _find_source_without(model: Model, element: Element) -> str | None:
    """Return the name of the file that xacro made the model from, if that includes no other and lacks an element's plugin."""
    file, plugin = model.source.files[model.source.name], element.parent
    written = read_xacro_source(file.text)
    found = [] if written is None else find_files_elsewhere(written, file.path, model.source.finder)
    name = "" if plugin is None else plugin.get("filename").strip()
    if len(found) != 1 or not name or not model.source.finder.can_open(found[0]):
        return None
    text = read_text_or_nothing(found[0])
    return None if not text or name in text or "include" in text else found[0].name


def _describe_absence(model: Model, package: str, below: str) -> str:
    """Say that a package that is here lacks the file that the repair names."""
    folder = model.source.finder.find(package)
    if folder is None or os.path.isfile(model.source.finder.find_source(folder / below)):
        return ""
    return f"; {package} has no {below} here, so add that file too"


def _find_portable_path(model: Model, parameters: ParameterFile) -> tuple[str, str] | None:
    """Return the model's package and the path of a file in it; None if the file is unknown or elsewhere.

    A package inside another one is not built: the outer one installs its files, as the typed path shows.
    """
    package, path = model.source.package, parameters.path
    if package is None or path is None or not path.is_relative_to(package.path):
        return None
    installed, outer = _INSTALLED.search(parameters.text), model.source.finder.find_package_of(package.path)
    if installed is not None and outer is not None and outer.name == installed[1]:
        package = outer
    return package.name, path.relative_to(package.path).as_posix()


def _names_other_simulator(model: Model) -> bool:
    """Whether another simulator than Gazebo provides the robot's hardware: Gazebo's plugin is left over."""
    controls = [control for control in model.robot.find_children("ros2_control") if is_simulated_hardware(control)]
    hardware = [element.text for control in controls for element in control.walk() if element.tag == "plugin"]
    is_expanded = model.source.is_output_of_xacro or not model.source.is_xacro
    return bool(hardware) and not any(map(_OF_GAZEBO.search, hardware)) and is_expanded


def _is_in_container(model: Model, path: str) -> bool:
    """Whether the repository describes a container that has its workspace where a path leads: it is the same on each machine."""
    finder, workspace = model.source.finder, _WORKSPACE.match(path)
    if workspace is None:
        return False
    place = re.compile(rf"(?<![\w./-]){re.escape(workspace[1])}(?![\w-])")
    folders = [level / below for level in finder.list_parent_folders() for below in _CONTAINER_FOLDERS]
    files = (file for folder in folders if finder.can_open(folder) for file in _list_entries(folder))
    return any(
        place.search(read_text_or_nothing(file)) is not None
        for file in files
        if CONTAINER_FILE.search(file.name) and finder.can_open(file)
    )


def _list_entries(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError:  # most projects have no such folder
        return []


def _read_package_in_path(model: Model, path: str) -> tuple[str, str] | None:
    """Read a package and a path in it from the path of another machine: behind ``share/``, or of a package that is known, if
    possible of one that has the file."""
    installed = _INSTALLED.search(path)
    if installed is not None:
        return installed[1], installed[2]
    parts = path.strip("/").split("/")
    finder, known = model.source.finder, []
    for number, part in enumerate(parts[:-1]):
        folder, below = finder.find_by_manifest(part), "/".join(parts[number + 1 :])
        if folder is not None:
            has_file = finder.can_open(folder / below) and (folder / below).is_file()
            known.append((has_file, number, part, below))
    return max(known)[2:] if known else None


def _check_unknown_joints(
    model: Model, rule: Rule, config: AssociatedConfiguration, *, elsewhere: PackageNames, named: Path | None
) -> Iterator[Finding]:
    """Report each name that no joint of the robot or of another robot of the package has.

    If the robot has no joint of a file that it names itself, report each controller. ``named``: the file that the robot names;
    then one that nothing loads is only a left-over.
    """
    # A joint of ros2_control that the robot lacks is an error of that block.
    known = model.joint_by_name.keys() | (collect_command_interfaces(model) or {}).keys()
    if config.named_at is not None and not config.configuration.joint_names & known:
        yield from _check_foreign_controllers(model, rule, config, elsewhere=elsewhere)
        return
    uses = _collect_unknown_joints(model, config.configuration.controllers, known=known, elsewhere=elsewhere)
    if uses and config.named_at is None and _is_for_another_model(model, config):
        return
    is_unloaded = bool(uses) and _is_left_over(model, config)
    # A joint that another controller of the file names is meant there, and two names do not mean one joint.
    unnamed = frozenset(model.joint_by_name) - config.configuration.joint_names
    nearest = Counter(find_nearest_name(name, unnamed) for name in [*uses][:MOST_HINTS])
    shared = {near for near, times in nearest.items() if near is not None and times > 1}
    for index, (name, places) in enumerate(uses.items()):
        is_for_moveit = all(controller.dialect == "moveit" for controller, _ in places)
        lacking = _list_joints_without_controller(model, config) if is_for_moveit else []
        # In one file, controllers of ROS may name what those of MoveIt lack.
        free = (frozenset(lacking) if is_for_moveit else unnamed) - shared if index < MOST_HINTS else frozenset[str]()
        near, hint = find_only_near_name(name, free), format_name_hint(name, free)
        # If the robot names no file, one with a misspelt name of its joints is the robot's.
        is_left_over = is_unloaded and (named is not None or not hint)
        if is_for_moveit and not hint and (not lacking or _is_virtual(model, name)):
            message, severity = "extra", Severity.INFO
        elif all(controller.ignores_joints for controller, _ in places):
            message, severity = "ignored", Severity.INFO
        elif is_left_over:
            message, severity = "left-over", Severity.WARNING if named is None else Severity.INFO
        else:
            message, severity = "unknown", Severity.WARNING if lacking and not hint else Severity.ERROR
        finding = rule.finding(
            message,
            at=places[0][1],
            severity=severity,
            related=[*(value for _, value in places[1:]), *_to_list(config.named_at)],
            edits=[edit for _, value in places for edit in value.build_edits(near)] if near is not None else (),
            controller=join_names(dict.fromkeys(controller.name for controller, _ in places)),
            joint=name,
            near=hint,
            kind="only the SRDF's virtual joint" if _is_virtual(model, name) else "no joint of the robot",
            rest="" if lacking else "; every joint that MoveIt moves has a controller without it",
            why="no launch file here names this file"
            if named is None
            else f"the robot names {named.name} as its controllers, and no launch file here names this file",
        )
        if message == "unknown":
            finding = replace(
                finding, consequences=_predict_effects(finding, places, find_nearest_name(name, free), lacking)
            )
        yield finding


def _predict_effects(
    finding: Finding, places: Sequence[tuple[Controller, YamlValue]], near: str | None, lacking: Sequence[str]
) -> dict[str, str]:
    """Return what the programs do that read the controllers with an unknown joint.

    MoveIt asks a controller for the joints of a trajectory that it has, so a name too much is harmless, and one too few is not.
    """
    dialects = {controller.dialect for controller, _ in places}
    readers = {reader for dialect in dialects for reader in _READERS[dialect]}
    effects = {reader: text for reader, text in finding.consequences.items() if reader in readers}
    if "moveit" in dialects and (near is not None or lacking):
        missed = near or join_names(lacking, 3)
        effects["moveit"] = f"plans, but executes no motion of {missed}, which no controller of this file has"
    return effects


def _list_joints_without_controller(model: Model, config: AssociatedConfiguration) -> list[str]:
    """List the joints that MoveIt plans for and that no controller of its kind in a file has: an unknown name may mean one."""
    named = {j.text for c in config.configuration.controllers if c.dialect == "moveit" for j in c.joints}
    return [
        joint.name for joint in model.joints if joint.is_movable and joint.mimic is None and joint.name not in named
    ]


def _is_virtual(model: Model, name: str) -> bool:
    """Whether an SRDF of the robot has a virtual joint of this name."""
    return any(name in srdf.virtual_joints for srdf in semantic_descriptions(model))


def _has_moving_virtual_joint(model: Model, name: str) -> bool:
    """Whether an SRDF has a virtual joint of this name that moves: MoveIt plans for it like for a joint of the robot."""
    joints = (joint for srdf in semantic_descriptions(model) for joint in srdf.root.find_children("virtual_joint"))
    return any(joint.get("name").strip() == name and joint.get("type").strip() != "fixed" for joint in joints)


def _is_left_over(model: Model, config: AssociatedConfiguration) -> bool:
    """Whether neither the robot, nor a launch file, nor a semantic description shows that it loads this file."""
    if config.named_at is not None or semantic_descriptions(model):
        return False
    from urdfcheck.source.launch.model_launches import may_load_yaml  # few robots have a file that they do not name

    return not may_load_yaml(model.source.path, model.source.finder, config.configuration.path.name)


def _is_for_another_model(model: Model, config: AssociatedConfiguration) -> bool:
    """Whether every launch file that loads the configuration loads another model with it."""
    from urdfcheck.source.launch.loaded_files import is_started_with_another  # loaded only if a name is unknown

    return is_started_with_another(config.configuration.path, model.source.path, model.source.finder)


def _collect_unknown_joints(
    model: Model, controllers: Iterable[Controller], *, known: Collection[str], elsewhere: PackageNames
) -> dict[str, list[tuple[Controller, YamlValue]]]:
    """Return the names that neither the robot nor its package knows, with the controllers and places that use them."""
    uses: dict[str, list[tuple[Controller, YamlValue]]] = {}
    for controller in controllers:
        missing = [
            j
            for j in controller.joints
            if j.text not in known
            and not elsewhere.can_package_have("joint", j.text)
            and not (controller.dialect == "moveit" and _has_moving_virtual_joint(model, j.text))
        ]
        # A controller without a joint of the robot may be for an optional tool.
        free = _list_unnamed_joints(model, controller)
        is_own = len(missing) < len(controller.joints) or any(
            find_nearest_name(j.text, free) for j in missing[:MOST_HINTS]
        )
        for joint in missing if is_own else ():
            uses.setdefault(joint.text, []).append((controller, joint))
    return uses


def _list_unnamed_joints(model: Model, controller: Controller) -> frozenset[str]:
    """Return the joints that a controller does not name, which an unknown name in it may mean."""
    return frozenset(model.joint_by_name) - {joint.text for joint in controller.joints}


def _check_foreign_controllers(
    model: Model, rule: Rule, config: AssociatedConfiguration, *, elsewhere: PackageNames
) -> Iterator[Finding]:
    """Report the controllers of another robot, unless other arguments may give this robot's joints their names.

    Where another file of the package has all the joints, the controllers fit that one, and the model names a wrong file.
    """
    foreign = [
        controller
        for controller in config.configuration.controllers
        if not controller.ignores_joints
        and not any(elsewhere.can_variants_have("joint", joint.text) for joint in controller.joints)
    ]
    own = join_names(joint.name for joint in model.joints if joint.is_movable) or "no joint that moves"
    names = dict.fromkeys(joint.text for controller in foreign for joint in controller.joints)
    fitting = elsewhere.find_other_file_with("joint", names) if foreign else None
    if fitting is not None and config.named_at is not None:
        yield rule.finding(
            "fits-another",
            at=config.named_at,
            related=[controller.key for controller in foreign],
            severity=Severity.WARNING if is_named_nowhere(model.source) else None,
            controllers=join_names(controller.name for controller in foreign),
            yaml=config.configuration.path.name,
            fitting=format_path(fitting),
            joints=join_names(names),
            own=own,
        )
        return
    for controller in foreign:
        yield rule.finding(
            "none",
            at=controller.key,
            related=_to_list(config.named_at),
            controller=controller.name,
            joints=join_names(joint.text for joint in controller.joints),
            own=own,
        )


def _check_command_interfaces(model: Model, rule: Rule, config: AssociatedConfiguration) -> Iterator[Finding]:
    """Report joints that a controller of ros2_control cannot claim."""
    offered = collect_command_interfaces(model)
    if offered is None:
        return
    reported: set[str] = set()
    for controller in config.configuration.controllers:
        wanted = controller.claimed_interfaces if controller.dialect == "ros2" else ()
        for value in controller.commanded_joints if wanted else ():
            joint = model.joint_by_name.get(value.text)
            lacking = [kind for kind in wanted if kind not in offered.get(value.text, ())]
            if joint is None or not lacking or value.text in reported:
                continue
            if all(can_offer_with_other_arguments(model, value.text, kind) for kind in lacking):
                continue  # the controller may be for those arguments
            reported.add(value.text)
            data: dict[str, Any] = {"controller": controller.name, "joint": joint.name, "kind": ", ".join(lacking)}
            if joint.type == "fixed":
                yield rule.finding("fixed", at=value, related=[joint], **data)
            elif not offered.get(value.text):
                follows = joint.mimic is not None
                repair = (
                    f"remove {joint.name} from the controller: it follows another joint by <mimic>"
                    if follows
                    else f"remove the joint from the controller; or, if the hardware drives it, add "
                    f'<joint name="{joint.name}"> with <command_interface name="{data["kind"]}"/> to the ros2_control block'
                )
                yield rule.finding("uncommanded", at=value, related=[joint], repair=repair, **data)
            else:
                kinds = ", ".join(sorted(offered[value.text]))
                yield rule.finding("interface", at=value, severity=Severity.WARNING, related=[joint], own=kinds, **data)


def _check_gpios(model: Model, rule: Rule, config: AssociatedConfiguration) -> Iterator[Finding]:
    """Report the interfaces that a controller of gpios claims and that no block offers, together for each controller.

    A file beside the model may be for another variant of its hardware: then a block must have the gpio.
    """
    lacking: dict[str, list[GpioClaim]] = {}
    for claim in config.configuration.gpio_claims:
        offered = collect_interfaces(model, claim.role, ("gpio", "joint", "sensor"))
        own = None if offered is None else offered.get(claim.component.text)
        if offered is None or (own is None and config.named_at is None):
            continue
        if own is None or claim.interface.text not in own:
            lacking.setdefault(claim.controller, []).append(claim)
    names = {controller.name for controller in config.configuration.controllers}
    for controller, claims in lacking.items():
        is_unstarted = is_left_unstarted(model, controller, names - {controller})
        yield rule.finding(
            "gpio-unstarted" if is_unstarted else "gpio",
            at=claims[0].interface,
            related=[*(claim.interface for claim in claims[1:]), *_to_list(config.named_at)],
            severity=Severity.INFO if is_unstarted else Severity.WARNING,
            controller=controller,
            first=f"{claims[0].component.text}/{claims[0].interface.text}",
            missing=join_names(f"{c.component.text}/{c.interface.text} ({c.role})" for c in claims),
            gpio=claims[0].component.text,
            role=claims[0].role,
            interface=claims[0].interface.text,
        )


def _check_wheel_geometry(
    model: Model, rule: Rule, controller: Controller, *, elsewhere: PackageNames | None, rel_tol: float
) -> Iterator[Finding]:
    """Report a wheel radius or separation that is not the model's, unless the wheels may be those of a robot ``elsewhere``."""
    from urdfcheck.model.ground.drive_wheels import (
        find_other_size,
        list_drive_wheels,
        measure_wheel_radii,
        measure_wheel_separations,
    )

    left, right = list_drive_wheels(controller)
    names = [value.text for value in (*left, *right)]
    if not left or not right or not all(name in model.joint_by_name for name in names):
        return
    if elsewhere is not None and any(elsewhere.can_others_have("joint", name) for name in names):
        return
    measured = {"wheel_radius": measure_wheel_radii(model, names[0])}
    if len(left) == len(right) == 1:  # the track of a skid steer is tuned to the ground
        measured["wheel_separation"] = measure_wheel_separations(model, left[0].text, right[0].text)
    for key, sizes in measured.items():
        typed = controller.parameters.get(key)
        value = None if typed is None else typed.number
        real = None if value is None else find_other_size(value, sizes, rel_tol=rel_tol)
        if typed is not None and value is not None and real is not None:
            yield rule.finding(
                key.removeprefix("wheel_"),
                at=typed,
                related=[model.joint_by_name[name] for name in names],
                severity=Severity.WARNING,
                edits=_build_size_edits(typed, real, sizes, rel_tol=rel_tol),
                controller=controller.name,
                value=value,
                real=real,
                off=abs(value - real) / real,
                left=names[0],
                right=right[0].text,
            )


def _check_other_drive(
    model: Model, rule: Rule, controller: Controller, *, elsewhere: PackageNames | None, rel_tol: float
) -> Iterator[Finding]:
    """Report a size of a mecanum drive or a tricycle that is not the model's."""
    from urdfcheck.model.ground.drive_wheels import find_other_size, measure_drive_sizes

    drive = measure_drive_sizes(model, controller)
    if drive is None or (elsewhere is not None and any(elsewhere.can_others_have("joint", n) for n in drive.joints)):
        return
    for key, typed, sizes in drive.sizes:
        value = typed.number
        real = None if value is None else find_other_size(value, sizes, rel_tol=rel_tol)
        if value is not None and real is not None:
            yield rule.finding(
                "drive",
                at=typed,
                related=[model.joint_by_name[name] for name in drive.joints],
                severity=Severity.WARNING,
                edits=_build_size_edits(typed, real, sizes, rel_tol=rel_tol),
                controller=controller.name,
                key=key,
                value=value,
                real=real,
                off=abs(value - real) / real,
                joints=join_names(drive.joints),
            )


def _mention_other_users(model: Model, config: AssociatedConfiguration, finding: Finding) -> Finding:
    """Add to a repair which other robots include what names the controllers file: a number may not fit their wheels."""
    span = None if config.named_at is None else config.named_at.location.span
    others = [] if span is None else find_other_includers(model.source, span.file)
    # Who includes the wheels with it gets the same ones.
    wheels = {place.span.file for place in finding.related if place.span is not None}
    if span is None or span.file in wheels or not others or finding.fix is None:
        return finding
    reader = f"{join_names(others, 2)} {'reads' if len(others) == 1 else 'read'} this file too, through {Path(span.file).name}"
    title = f"{finding.fix.title}; {reader}: if the wheels differ, give each robot its own file"
    return replace(finding, fix=Fix(title))


def _build_size_edits(typed: YamlValue, real: float, sizes: Sequence[float], *, rel_tol: float) -> list[Edit]:
    """Return the edits that write a size, if all that the model shows agree on it."""
    agrees = max(sizes) - min(sizes) <= rel_tol * min(sizes)
    return [*typed.build_edits(keep_notation(typed.text, f"{real:.4g}"))] if agrees else []


def _to_list(place: Located | None) -> list[Located]:
    return [] if place is None else [place]
