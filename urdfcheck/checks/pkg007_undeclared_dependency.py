"""PKG007 reports packages that a package names and does not declare as dependencies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.package.finder import Package, load_package
from urdfcheck.source.package.references import PackageMention, read_package_contents
from urdfcheck.source.text.xml import Element, SourceFile

# Metapackages, and what the names of their packages begin with unless with the name of the metapackage.
_PARTS_OF = {
    "gazebo_ros_pkgs": ("gazebo_",),
    "ros_gz": ("ros_gz_", "ros_ign_"),
    "navigation2": ("nav2_",),
    "desktop": ("",),
    "desktop_full": ("",),
    "ros_base": ("",),
    "ros_core": ("",),
}
# The dependencies of so many packages are read.
_MAX_MANIFESTS = 1_000
# PKG001 reports unknown packages that other files name.
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".py")


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    root, file = package.root, package.file
    if root is None or file is None or root.tag != "package":
        return
    declared = {package.name, *package.dependencies}
    undeclared: dict[str, list[PackageMention]] = {}
    for mention in read_package_contents(package).mentions:
        if mention.package not in declared:
            undeclared.setdefault(mention.package, []).append(mention)
    covered = _collect_indirect_dependencies(package) if undeclared else set()
    parts = tuple(prefix for name in package.dependencies for prefix in _PARTS_OF.get(name, (f"{name}_",)))
    missing = {
        name: uses
        for name, uses in sorted(undeclared.items())
        if name not in covered and not name.startswith(parts) and _needs_declaration(name, uses, package)
    }
    if not missing:
        return
    tag = "run_depend" if root.get("format", "1").strip() == "1" else "exec_depend"
    names = list(missing)
    finding = rule.finding(
        "undeclared" if len(names) == 1 else "several",
        at=root.find_child("name") or root,
        related=[use.location for uses in missing.values() for use in uses[:3]],
        edits=_propose_edits(root, file, tag=tag, names=names),
        name=names[0],
        names=names,
        listed=join_names(names),
        count=len(names),
        package=package.name,
        tag=tag,
        where=", ".join(dict.fromkeys(use.location.span.file for use in missing[names[0]][:2] if use.location.span)),
        lines=" ".join(f"<{tag}>{name}</{tag}>" for name in names),
    )
    yield replace(finding, subjects=tuple(f"package[{package.name}]/{tag}[{name}]" for name in names))


def _collect_indirect_dependencies(package: Package) -> set[str]:
    """Return the dependencies of the declared dependencies that are found, and so on."""
    covered: set[str] = set()
    left = sorted(package.dependencies)
    for _ in range(_MAX_MANIFESTS):
        if not left or package.finder is None:
            break
        name = left.pop()
        folder = package.finder.find(name)
        further = (
            None if folder is None or not package.finder.can_open(folder / "package.xml") else load_package(folder)
        )
        if further is not None:
            left += sorted(further.dependencies - covered)
            covered |= further.dependencies
    return covered


def _needs_declaration(name: str, uses: list[PackageMention], package: Package) -> bool:
    """Whether a package must be declared: it is found, or only launch files name it, which fail without it."""
    if package.finder is not None and package.finder.find(name) is not None:
        return True
    return all(use.location.span is not None and use.location.span.file.endswith(_LAUNCH_SUFFIXES) for use in uses)


def _propose_edits(root: Element, file: SourceFile, *, tag: str, names: list[str]) -> list[Edit]:
    """Insert the missing lines behind the last dependency of their kind, else of any kind, else behind the last element."""
    dependencies = (
        root.find_children(tag)
        or root.find_children("depend")
        or [e for e in root.children if e.tag.endswith("depend")]
    )
    before = dependencies[-1] if dependencies else (root.children[-1] if root.children else None)
    if before is None or before.span is None:
        return []
    end = file.text.find(f"</{before.tag}>", before.span.end)
    if end < 0 or file.text[: before.span.end].endswith("/>"):
        return []
    end += len(f"</{before.tag}>")
    begin = file.text.rfind("\n", 0, before.span.start) + 1
    indent = file.text[begin : before.span.start]
    newline = "\r\n" if file.text[: before.span.start].endswith("\r\n" + indent) else "\n"
    text = "".join(f"{newline}{indent if not indent.strip() else ''}<{tag}>{name}</{tag}>" for name in names)
    return [Edit(file.make_span(end, end), "", text)]
