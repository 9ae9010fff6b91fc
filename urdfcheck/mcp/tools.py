"""What a language model can ask: each tool takes words and paths, and returns a page of a few thousand tokens.

Paths stay in the folder that the server was started for, after symbolic links. A file is written only where ``write`` is given,
and only in that folder, though models may include others.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.api import check, diff, diff_commits, prepare_worker_surroundings
from urdfcheck.core import Finding, Run, UrdfcheckError
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.fix.fixer import compute_fixes
from urdfcheck.fix.patch import iter_diff_lines, write_files
from urdfcheck.mcp.computed_values import describe_computed
from urdfcheck.mcp.pages import select_page
from urdfcheck.mcp.robot_summary import summarize_robot
from urdfcheck.output import render_picture
from urdfcheck.output.agent import MOST_CHARACTERS, name_finding, render_findings
from urdfcheck.output.changes import text as changes
from urdfcheck.rule_pages import explain_page
from urdfcheck.rules import load_rules, select_rules
from urdfcheck.run.pipeline import audit_single_model
from urdfcheck.run.request import RunOptions, make_request

# A finding is also named by a longer beginning of its fingerprint.
_LEAST_DIGITS = 6


class Workspace:
    """The folder that the tools may read, and write where they are told to."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def check(self, paths: Sequence[str], select: str = "", target: str = "", page: int = 1) -> str:
        """Return the findings about models, packages or folders, the worst first."""
        run = self._run(paths, select=select, target=target)
        more = f"page={page + 1} has the next, select=CODE those of a rule"
        return render_findings(run, run.active_findings, page=page, more=more)

    def explain(self, rule: str, page: int = 1) -> str:
        """Return the page of a rule: what it checks, why it matters, how to fix it, with examples."""
        pages = [explain_page(load_rules()[code].page) for code in sorted(select_rules([rule]))]
        return select_page("\n\n".join(pages), page)

    def fix(self, paths: Sequence[str], ids: Sequence[str], *, write: bool = False) -> str:
        """Compute the edits of some findings, check the edited files, and return the diff and what remains.

        ``ids``: as `check` returns them. An edit that makes anything worse is refused. ``write``: also write the files.
        """
        before = self._run(paths)
        wanted = self._find_named(before, ids)
        request, _ = make_request(RunOptions(paths=self._list_inside(paths)))
        with prepare_worker_surroundings():
            found = compute_fixes(
                request,
                include_unsafe=True,
                are_only_shown=not write,
                accepts=lambda finding: _is_one_of(finding, wanted),
            )
        lines = [f"refused: {finding.code} {finding.headline}: {reason}" for finding, reason in found.refused]
        if not found.changes:
            return "\n".join(["nothing to change", *lines])
        done = "written" if write else "not written: give write=true to write it"
        for path, (old, new) in found.changes.items():
            lines += [line.rstrip("\n") for line in iter_diff_lines(path, old, new)]
        if write:
            write_files(found.changes)
        after = render_findings(
            found.outcome, found.outcome.active_findings, most=MOST_CHARACTERS // 2, more="check lists them"
        )
        return f"{_shorten_diff(lines)}\n{done}\n\nafter it: {after}"

    def compare(self, before: str, after: str, *, verbose: bool = False, page: int = 1) -> str:
        """Say what the change from one model, package or folder to another does to the robot."""
        first, second = self._list_inside([before, after])
        return select_page(changes.render(diff(first, second), show_all=verbose), page)

    def compare_commits(
        self, revisions: str = "HEAD", paths: Sequence[str] = (), *, verbose: bool = False, page: int = 1
    ) -> str:
        """Say what a change of the git repository does to the robots: REV against the work tree, or REV..REV."""
        inside = [os.path.relpath(path, self.root) for path in self._list_inside(paths)]
        found = diff_commits(revisions, inside, repository=self.root)
        return select_page(changes.render(found, show_all=verbose), page)

    def expand(self, path: str, words: str = "", page: int = 1) -> str:
        """Return what the expressions of a model became and where their numbers were typed.

        ``words``: part of a place (``arm.xacro:12``), of an element (``link[arm]/inertial``) or of an expression (``arm_mass``).
        """
        request, _ = make_request(RunOptions(paths=self._list_inside([path]), tier="source"))
        with prepare_worker_surroundings():
            report = audit_single_model(replace(request, options=replace(request.options, index=True)))
        if report.index is None:
            raise UrdfcheckError(f"{path} was not read: check it")
        return select_page(describe_computed(report.index, words), page)

    def describe(self, path: str, page: int = 1) -> str:
        """Return a robot on one page: the tree, masses, joints, limits and reach."""
        run = check(self._list_inside([path]), scene=True)
        if not run.scenes:
            return render_findings(run, run.active_findings, more="check lists them")
        return select_page("\n\n".join(map(summarize_robot, run.scenes)), page)

    def draw(self, path: str) -> bytes:
        """Return a picture (PNG) of the robot with its findings marked.

        :raises UrdfcheckError: when there are several models, or none that can be drawn.
        """
        return render_picture(check(self._list_inside([path]), scene=True))

    def _run(self, paths: Sequence[str], *, select: str = "", target: str = "") -> Run:
        return check(self._list_inside(paths), select=select.split() or None, target=target.split() or None)

    def _list_inside(self, paths: Sequence[str]) -> tuple[Path, ...]:
        """Return paths relative to the working directory.

        :raises UrdfcheckError: for a path that leads out of the folder of the server, or to nothing.
        """
        found = []
        for path in paths:
            real = self._find_inside(path)
            if not real.exists():
                raise UrdfcheckError(f"{path} does not exist in {self.root}")
            found.append(Path(os.path.relpath(real)))
        return tuple(found)

    def _find_inside(self, path: str) -> Path:
        """Return the real path of a file in the folder of the server.

        :raises UrdfcheckError: for one that is outside.
        """
        real = (self.root / path).resolve()
        if not real.is_relative_to(self.root):
            raise UrdfcheckError(f"{path} is outside {self.root}: start urdfcheck mcp in the folder that is meant")
        return real

    def _find_named(self, run: Run, ids: Sequence[str]) -> frozenset[str]:
        """Return the fingerprints of the findings with these ids, of all their places.

        :raises UrdfcheckError: for an id that no finding has, or whose finding has no edit in the folder of the server.
        """
        prints: set[str] = set()
        for name in ids:
            found = [
                f
                for f in run.active_findings
                if len(name) >= _LEAST_DIGITS and any(p.startswith(name) for p in f.fingerprints)
            ]
            if not found:
                known = ", ".join(name_finding(f) for f in run.active_findings if f.fix is not None and f.fix.edits)
                raise UrdfcheckError(f"no finding has the id {name!r}. Those with an edit: {known or 'none'}")
            for finding in found:
                if finding.fix is None or not finding.fix.edits:
                    raise UrdfcheckError(f"{name} {finding.code} has no edit: {finding.headline}")
                for edit in finding.fix.edits:
                    self._find_inside(os.path.abspath(edit.span.file))
                prints.update(p for own in iter_occurrences([finding]) for p in own.fingerprints)
        return frozenset(prints)


def _is_one_of(finding: Finding, prints: frozenset[str]) -> bool:
    return not prints.isdisjoint(finding.fingerprints)


def _shorten_diff(lines: Sequence[str]) -> str:
    text = "\n".join(lines)
    if len(text) <= MOST_CHARACTERS // 2:
        return text
    kept = text[: MOST_CHARACTERS // 2].rsplit("\n", 1)[0]
    return f"{kept}\n… {len(text) - len(kept)} characters more (give fewer ids)"
