"""KIN005 reports groups of links that no joint connects to the rest."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.link_graph import KinematicGraph
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.xacro.usage import collect_called_macros, collect_macros


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    graph = KinematicGraph.from_model(model)
    parents = graph.map_parent_joints()
    explained, unknown = _find_explained_links(graph)
    pieces = [
        piece
        for piece in graph.find_components()
        if not explained & set(piece) and any(not parents[link] for link in piece)  # otherwise a loop: KIN004
    ]
    if len(pieces) - unknown < 2:
        return
    roots = [next(link for link in piece if not parents[link]) for piece in pieces]
    # The file of the model as typed: what an included file makes may be needed by the other models that include it.
    spans = [model.link_by_name[root].element.span for root in roots]
    is_own = all(span is not None and span.file == model.source.name for span in spans)
    others = join_names(
        f"{root} ({format_count(len(piece), 'link')})" for root, piece in zip(roots[1:], pieces[1:], strict=True)
    )
    joints = _find_joints_elsewhere(model)
    if joints is not None:
        yield rule.finding(
            "half",
            at=model.robot,
            severity=Severity.INFO,
            count=len(pieces),
            file=format_path(joints),
        )
        return
    from urdfcheck.model.use.started_variants import find_needed_variant  # few models need it

    needed = find_needed_variant(model.source, lambda variant: len(variant.list_roots()) == 1)
    if needed is not None:
        yield rule.finding(
            "default",
            at=model.link_by_name[roots[1]],
            severity=Severity.WARNING,
            related=[model.link_by_name[roots[0]], *needed.list_declarations()],
            count=len(pieces),
            main=f"{roots[0]} ({format_count(len(pieces[0]), 'link')})",
            others=others,
            **needed.shown,
        )
        return
    is_nameless = model.source.is_xacro and "name" not in model.robot.attributes
    yield rule.finding(
        "pieces",
        at=model.link_by_name[roots[1]],
        # Without a name no program takes it for a robot: it is a part, or lacks the name too.
        severity=Severity.WARNING if is_nameless else None,
        related=[model.link_by_name[root] for root in (roots[0], *roots[2:10])],
        count=len(pieces),
        main=f"{roots[0]} ({format_count(len(pieces[0]), 'link')})",
        others=others,
        roots=roots,
        inside="" if is_own else f" in {Path(model.source.name).name}",
        repair=_describe_repair(model, roots, [len(piece) for piece in pieces], is_own=is_own),
    )


def _describe_repair(model: Model, roots: list[str], sizes: list[int], *, is_own: bool) -> str:
    """Say what to do; ``is_own``: the roots are typed in the model's own file."""
    from urdfcheck.model.likeness.whole_models import find_joining_robot  # loaded only for such a file

    joining = find_joining_robot(model)
    if joining is not None:
        return f"load {format_path(joining)}: it includes this file and has the joints; joints added here would be doubled there"
    joints = _describe_joints(roots, sizes)
    return joints + (", or delete unused links" if is_own else _describe_own_place(model))


def _find_joints_elsewhere(model: Model) -> Path | None:
    if model.joints:
        return None
    from urdfcheck.model.likeness.whole_models import find_joints_elsewhere  # loaded only for such a file

    return find_joints_elsewhere(model.source)


def _describe_own_place(model: Model) -> str:
    """Say where a joint belongs between what included files make; a macro may make it itself if its call says to which link."""
    made = {joint.element.span for joint in model.joints}
    for macro in collect_macros(model.source.trees).values():
        typed = (e for e in macro.element.walk() if e.tag == "joint" and e.span not in made)
        parents = (parent.get("link").strip() for e in typed if (parent := e.find_child("parent")) is not None)
        handed = next((name[2:-1] for name in parents if name[:2] == "${" and name[2:-1] in macro.parameters), None)
        if handed is not None and macro.name in collect_called_macros(model.source.trees):
            return f", in the model's own file, or pass {handed} to macro {macro.name}, which then makes one"
    return ", in the model's own file"


def _describe_joints(roots: list[str], sizes: list[int]) -> str:
    """Say which joints are missing: a single link that stands for the ground is the parent."""
    if len(roots) == 2:
        for (ground, size), other in zip(zip(roots, sizes, strict=True), reversed(roots), strict=True):
            if size == 1 and (ground == "world" or ground.endswith("footprint")):
                return f"add a joint, often a fixed one, from {ground} to {other}"
    return "add the joints that are missing, often fixed ones"


def _find_explained_links(graph: KinematicGraph) -> tuple[set[str], int]:
    """Return the links that are separate because a joint names a wrong link, and the number of other wrong names.

    KIN002, KIN006 and XML005 report those joints; each of the other names may explain one piece.
    """
    links: set[str] = set()
    unknown = 0
    for joint in graph.broken:
        if joint.child in graph.links:
            links.add(joint.child)
            continue
        meant = graph.guess_link("child", joint.child) if joint.child else None
        if meant is None:
            unknown += 1
        else:
            links.add(meant)
    return links, unknown
