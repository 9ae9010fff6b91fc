"""PKG007: a package depends on the packages that its files name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.core.text import listed
from urdfcheck.source.package.finder import Package, load_package
from urdfcheck.source.package.references import Mention, contents_of
from urdfcheck.source.text.xml import Element, SourceFile

# Packages that stand for many, whose names begin otherwise.
_PARTS_OF = {
    "gazebo_ros_pkgs": ("gazebo_",),
    "ros_gz": ("ros_gz_", "ros_ign_"),
    "navigation2": ("nav2_",),
    "desktop": ("",),
    "desktop_full": ("",),
    "ros_base": ("",),
    "ros_core": ("",),
}
# Packages that are looked for among the dependencies of dependencies.
_MOST_MANIFESTS = 1_000
# In a model these are PKG001's when they are not found.
_LAUNCHES = (".launch", ".launch.xml", ".py")


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    root, file = package.root, package.file
    if root is None or file is None or root.tag != "package":
        return
    declared = {package.name, *package.dependencies}
    named: dict[str, list[Mention]] = {}
    for mention in contents_of(package).mentions:
        if mention.package not in declared:
            named.setdefault(mention.package, []).append(mention)
    covered = _covered(package) if named else set()
    parts = tuple(prefix for name in package.dependencies for prefix in _PARTS_OF.get(name, (f"{name}_",)))
    missing = {
        name: uses
        for name, uses in sorted(named.items())
        if name not in covered and not name.startswith(parts) and _counts(name, uses, package)
    }
    if not missing:
        return
    tag = "run_depend" if root.get("format", "1").strip() == "1" else "exec_depend"
    names = list(missing)
    finding = rule.finding(
        "undeclared" if len(names) == 1 else "several",
        at=root.child("name") or root,
        related=[use.location for uses in missing.values() for use in uses[:3]],
        edits=_edits(root, file, tag, names),
        name=names[0],
        names=names,
        listed=listed(names),
        count=len(names),
        package=package.name,
        tag=tag,
        where=", ".join(dict.fromkeys(use.location.span.file for use in missing[names[0]][:2] if use.location.span)),
        lines=" ".join(f"<{tag}>{name}</{tag}>" for name in names),
    )
    yield replace(finding, subjects=tuple(f"package[{package.name}]/{tag}[{name}]" for name in names))


def _covered(package: Package) -> set[str]:
    """What comes with the declared dependencies, as far as these are found: they depend on it themselves."""
    covered: set[str] = set()
    left = sorted(package.dependencies)
    for _ in range(_MOST_MANIFESTS):
        if not left or package.finder is None:
            break
        name = left.pop()
        folder = package.finder.find(name)
        further = None if folder is None or not package.finder.allows(folder / "package.xml") else load_package(folder)
        if further is not None:
            left += sorted(further.dependencies - covered)
            covered |= further.dependencies
    return covered


def _counts(name: str, uses: list[Mention], package: Package) -> bool:
    """Whether a package is one that must be declared: it is found, or only launch files name it, which fail without it."""
    if package.finder is not None and package.finder.find(name) is not None:
        return True
    return all(use.location.span is not None and use.location.span.file.endswith(_LAUNCHES) for use in uses)


def _edits(root: Element, file: SourceFile, tag: str, names: list[str]) -> list[Edit]:
    """The missing lines behind the last dependency of their kind, or of any, or before the end, as their neighbours stand."""
    alike = root.all(tag) or root.all("depend") or [e for e in root.children if e.tag.endswith("depend")]
    before = alike[-1] if alike else (root.children[-1] if root.children else None)
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
    return [Edit(file.span(end, end), "", text)]
