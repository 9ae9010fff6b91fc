"""What packages depend on, through others that are found."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from urdfcheck.source.package.finder import Package, PackageFinder, has_dependency_entry, load_package

# The manifests of so many packages are read.
_MAX_MANIFESTS = 1_000


def collect_dependencies(finder: PackageFinder | None, names: Iterable[str]) -> set[str]:
    """Return the dependencies of these packages, as far as they are found, and of those, and so on."""
    return {name for package in _iter_packages(finder, names) for name in package.dependencies}


def find_dependent(package: Package, name: str, finder: PackageFinder) -> str | None:
    """Return the package whose manifest depends on another: this one, or one that it depends on; None if there is none."""
    if name in package.dependencies:
        return package.name
    below = _iter_packages(finder, package.dependencies)
    return next((inner.name for inner in below if name in inner.dependencies), None)


def find_dependent_in_project(name: str, finder: PackageFinder) -> str | None:
    """Return a package of the project whose manifest depends on another, for a file that is in no package."""
    packages = finder.list_workspace_packages()
    return next((own for own, folder in sorted(packages.items()) if has_dependency_entry(folder, name)), None)


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
