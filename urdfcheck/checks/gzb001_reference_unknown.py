"""GZB001 reports `<gazebo reference>` values that are neither a link nor a joint of the robot."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_count, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.model.fixed_joint_lumping import PRESERVE, names_fixed_part
from urdfcheck.model.likeness.sibling_robots import package_names
from urdfcheck.model.use.gazebo_starts import is_left_out_of_gazebo
from urdfcheck.source.text.grammar import UNFILLED
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.uses_elsewhere import find_other_includers

# What Gazebo reads for a link only, and for a joint only: the other kind is not what a block with it means.
_OF_LINKS = frozenset({
    "mu1", "mu2", "fdir1", "kp", "kd", "minDepth", "maxVel", "maxContacts", "laserRetro", "self_collide", "material",
    "selfCollide", "turnGravityOff", "gravity", "dampingFactor", "visual", "collision",
})  # fmt: skip
_OF_JOINTS = frozenset({
    "stopCfm", "stopErp", "provideFeedback", "implicitSpringDamper", "springStiffness", "springReference", "fudgeFactor",
    "disableFixedJointLumping", "preserveFixedJoint", "physics",
})  # fmt: skip
# What Gazebo does without these settings.
_DEFAULTS = {
    "gravity": frozenset({"true", "1"}),
    **dict.fromkeys(("turnGravityOff", "self_collide", "selfCollide", "provideFeedback"), frozenset({"false", "0"})),
}
# What contains links and joints that are not those of URDF.
_OTHER_BLOCKS = frozenset({"gazebo", "transmission", "ros2_control"})
# Words that name what a part is.
_SUFFIXES = ("_link", "_joint")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    known = {*model.link_by_name, *model.joint_by_name}
    unknown: dict[str, list[Attribute]] = {}
    # An empty block sets nothing, whatever it names.
    blocks = [e for e in model.robot.find_children("gazebo") if e.get("reference") and e.children]
    references = [block.attributes["reference"] for block in blocks]
    for reference in references:
        if reference.value not in known:
            unknown.setdefault(reference.value, []).append(reference)
    # A part that has a block already is not what another block means.
    free = known - {reference.value for reference in references}
    templates = [use for name, uses in unknown.items() if UNFILLED.search(name) for use in uses]
    if templates:
        yield _build_template_finding(rule, templates)
    for name, uses in unknown.items():
        meant = _list_meant(model, free, uses)
        near = _find_by_suffix(name, meant) or find_only_near_name(name, meant, SLIP_LIKENESS)
        hint = _hint_fixed_joint(model, free, uses) or format_name_hint(name, meant)
        # How a reference is typed says less than its name: where it is like one of the robot, that is meant.
        typed = {use.typed for use in uses if "$" in use.typed and near is None and not hint}
        optional = _find_optional_part(model, name, typed)
        if optional is not None:
            yield rule.finding(
                "optional",
                at=uses[0],
                related=[optional, *uses[1:]],
                severity=Severity.INFO,
                reference=name,
                kind=optional.tag,
                content=_join_child_tags(uses),
            )
        elif _is_of_sibling(model, name, uses) or (typed and _is_typed_by_sibling(model, uses)):
            yield rule.finding(
                "shared",
                at=uses[0],
                related=uses[1:],
                severity=Severity.INFO,
                reference=name,
                content=_join_child_tags(uses),
            )
        elif not UNFILLED.search(name):
            # A colour is nothing that a simulation misses, unless a slip in the name shows what it is for.
            is_colour = {child.tag for use in uses for child in use.owner.children} == {"material"}
            is_lost_colour = is_colour and near is None and not hint
            is_idle = near is None and not hint and not is_colour and _changes_nothing(model, name, uses)
            # What xacro wrote is not where a name is corrected.
            is_note = is_lost_colour and model.source.is_output_of_xacro
            yield rule.finding(
                "idle" if is_idle else "colour" if is_note else "unknown",
                at=uses[0],
                severity=Severity.INFO if is_idle or (is_colour and near is None) else None,
                related=[*uses[0].collect_definitions(), *uses[1:]],
                edits=build_replacement_edits(uses, near) if near is not None else (),
                reference=name,
                near=f" (did you mean {near!r}?)" if near is not None else hint,
                content=_join_child_tags(uses),
            )


def _changes_nothing(model: Model, name: str, uses: Sequence[Attribute]) -> bool:
    """Whether all that blocks set is what Gazebo does without them, or a colour that no part of Gazebo's would show."""
    settings = [child for use in uses for child in use.owner.children]
    is_unseen = name == "world" or is_left_out_of_gazebo(model)
    return all(
        is_unseen if child.tag == "material" else child.text.strip().lower() in _DEFAULTS.get(child.tag, ())
        for child in settings
    )


def _list_meant(model: Model, free: set[str], uses: Sequence[Attribute]) -> set[str]:
    """Return the links or the joints if the settings of the blocks are only read for these, else both."""
    settings = {child.tag for use in uses for child in use.owner.children}
    of_links, of_joints = bool(settings & _OF_LINKS), bool(settings & _OF_JOINTS)
    if of_links != of_joints:
        return free & set(model.link_by_name if of_links else model.joint_by_name)
    return free


def _hint_fixed_joint(model: Model, free: set[str], uses: Sequence[Attribute]) -> str:
    """Return a hint at the fixed joint that a block wants to keep: ``foot_fixed`` for ``foot_joint``, or nothing."""
    if not any(child.tag in PRESERVE for use in uses for child in use.owner.children):
        return ""
    found = [joint.name for joint in model.joints if joint.name in free and names_fixed_part(uses[0].value, joint)]
    return f" (did you mean {found[0]!r}?)" if len(found) == 1 else ""


def _find_by_suffix(name: str, known: set[str]) -> str | None:
    """Return the known name that only has `_link` or `_joint` more or less."""
    found = {name + suffix for suffix in _SUFFIXES} | {name.removesuffix(suffix) for suffix in _SUFFIXES}
    found = (found & known) - {name}
    return found.pop() if len(found) == 1 else None


def _find_optional_part(model: Model, name: str, typed: Collection[str]) -> Element | None:
    """Return the link or joint of this name in a file that the model can include, which this variant leaves out.

    ``typed``: texts with expressions that give the name; a link or joint whose name is typed so and that nothing made is meant.
    """
    if not model.source.is_xacro:
        return None
    from urdfcheck.source.xacro.argument_values import read_included_trees  # loaded only if a reference is unknown

    trees = read_included_trees(model.source.path, model.source.finder)
    parts = [part for tree, _ in trees for part in tree.walk() if part.tag in {"link", "joint"} and _is_of_urdf(part)]
    elements = [*(link.element for link in model.links), *(joint.element for joint in model.joints)]
    names = (element.attributes.get("name") for element in elements)
    made = {None if attribute is None else attribute.span for attribute in names}
    # What made a part of another name would make this one where it is called for it.
    idle = (part for part in parts if part.get("name") in typed and part.attributes["name"].span not in made)
    return next((part for part in parts if part.get("name") == name), None) or next(idle, None)


def _is_of_urdf(part: Element) -> bool:
    """Whether a link or joint is one of the robot's: not of SDF, and not the mention of a joint in a block for controllers."""
    around = part.parent
    while around is not None and around.tag not in _OTHER_BLOCKS:
        around = around.parent
    return around is None


def _is_of_sibling(model: Model, name: str, uses: Sequence[Attribute]) -> bool:
    """Whether all blocks are in files that the model includes, or of which xacro made it, and another file of the package has
    the link or joint: the blocks are for several robots."""
    typed = {None if use.span is None else use.span.file for use in uses}
    is_included = model.source.is_output_of_xacro or model.source.name not in typed
    return is_included and any(package_names(model).is_spelled_elsewhere(kind, name) for kind in ("link", "joint"))


def _is_typed_by_sibling(model: Model, uses: Sequence[Attribute]) -> bool:
    """Whether all blocks are in files that other files of the package include too, and one that the model does not use has a link
    or joint whose name is typed like the reference, ``${name}_finger``: the blocks are for several robots."""
    names = package_names(model)
    return all(
        use.span is not None
        and any(names.is_typed_elsewhere(kind, use.typed) for kind in ("link", "joint"))
        and find_other_includers(model.source, use.span.file)
        for use in uses
    )


def _build_template_finding(rule: Rule, uses: list[Attribute]) -> Finding:
    """Report together all references that a script failed to fill in."""
    finding = rule.finding(
        "template",
        at=uses[0],
        related=uses[1:10],
        names=join_names(dict.fromkeys(use.value for use in uses)),
        which=format_count(len(uses), "<gazebo> block refers", "<gazebo> blocks refer"),
        example=UNFILLED.findall(uses[0].value)[0],
        content=_join_child_tags(uses),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(use.location.subject for use in uses)))


def _join_child_tags(uses: list[Attribute]) -> str:
    """Join the names of the settings in the blocks."""
    return ", ".join(dict.fromkeys(child.tag for use in uses for child in use.owner.children))
