"""PKG008: a ROS 2 package installs the folders that models and launch files look for in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import listed
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.installed_folders import installed
from urdfcheck.source.package.references import Mention, mentions_around


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    done = installed(package)
    if done is None or done.everything:
        return
    missing: dict[str, list[Mention]] = {}
    for mention in mentions_around(package):
        folder = mention.folder
        if folder and folder not in done.names and (package.path / folder).is_dir():
            missing.setdefault(folder, []).append(mention)
    if not missing:
        return
    folders = sorted(missing)
    finding = rule.finding(
        f"{done.form}-several" if len(folders) > 1 else done.form,
        at=done.at,
        related=[mention.location for name in folders for mention in missing[name][:3]],
        edits=done.edits(folders),
        package=package.name,
        folder=folders[0],
        folders=folders,
        listed=listed(folders),
        spaced=" ".join(folders),
        example=f"{folders[0]}{missing[folders[0]][0].inside.lstrip('/')[len(folders[0]) :]}",
    )
    yield replace(finding, subjects=tuple(f"package[{package.name}]/install[{name}]" for name in folders))
