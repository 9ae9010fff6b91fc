"""PKG008 reports folders that models and launch files read but that a ROS 2 package does not install."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.installed_files import InstalledFiles
from urdfcheck.source.package.installed_folders import read_install_rules
from urdfcheck.source.package.references import PackageMention, iter_package_mentions

# The launch files of ROS 1.
_OLD_LAUNCH = ".launch"


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    install = read_install_rules(package)
    if install is None:
        return
    missing: dict[str, list[PackageMention]] = {}
    for mention in iter_package_mentions(package):
        folder = mention.folder
        if _is_left_in_source(mention, package, install.installed):
            continue
        if folder and not install.installed.may_fill(folder) and (package.path / folder).is_dir():
            missing.setdefault(folder, []).append(mention)
    if not missing:
        return
    folders = sorted(missing)
    finding = rule.finding(
        f"{install.build_form}-several" if len(folders) > 1 else install.build_form,
        at=install.at,
        related=[mention.location for name in folders for mention in missing[name][:3]],
        edits=install.build_edits(folders),
        package=package.name,
        folder=folders[0],
        folders=folders,
        listed=join_names(folders),
        spaced=" ".join(folders),
        example=f"{folders[0]}{missing[folders[0]][0].subpath.lstrip('/')[len(folders[0]) :]}",
    )
    yield replace(finding, subjects=tuple(f"package[{package.name}]/install[{name}]" for name in folders))


def _is_left_in_source(mention: PackageMention, package: Package, installed: InstalledFiles) -> bool:
    """Whether a package is named by its own launch file of ROS 1, which is not installed either: a left-over."""
    span = mention.location.span
    if span is None or not span.file.endswith(_OLD_LAUNCH):
        return False
    own, file = package.path.absolute(), Path(os.path.abspath(span.file))
    folders = file.relative_to(own).parts[:-1] if file.is_relative_to(own) else ()
    return bool(folders) and not installed.may_fill(folders[0])
