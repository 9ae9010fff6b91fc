"""``urdfcheck init [FOLDER]``: a configuration, a pre-commit entry and a CI job for the models of a repository."""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.cli.install_origin import InstallOrigin, find_install_origin
from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.output_files import CheckedFolders, write_file
from urdfcheck.cli.setup_step import SetupStep
from urdfcheck.cli.terminal import NOTHING, OK, make_progress_printer, say
from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import ModelInfo, Run

PRE_COMMIT, GITHUB, GITLAB = ".pre-commit-config.yaml", ".github/workflows/urdfcheck.yml", ".gitlab-ci.yml"
# The placeholder that the README uses; it is filled in where urdfcheck was installed from an address.
UNKNOWN = "…"
_WHAT_TO_INSTALL = "the address of urdfcheck, or the absolute path of a checkout"

CONFIGURATION = """\
# What holds for the models below this folder: urdfcheck config PATH shows it, urdfcheck rule lists the rules.
{table}fail-on = "error"                  # exit 1 at this severity or above: error, warning, info, never
# ignore = ["cad-noise"]           # codes, prefixes, names and tags of rules
# target = ["gazebo", "moveit"]    # who will read the models
# exclude = ["third_party"]        # skipped when a folder is checked

# [{prefix}severity]
# INR010 = "info"
"""
JOB = """\
name: urdfcheck
on: [push, pull_request]
permissions:
  contents: read
jobs:
  urdfcheck:
    runs-on: ubuntu-latest
    steps:
      - uses: actions/checkout@3d3c42e5aac5ba805825da76410c181273ba90b1 # v7.0.1
        with:
          persist-credentials: false
{steps}"""
# A GitHub address is used as an action; from any other address urdfcheck is installed. What stands in braces is quoted YAML.
ACTION = """\
      - uses: {action}
        with:
          paths: {folder}
"""
# Python lies outside of the checkout, and -I keeps it from taking modules there.
INSTALLED = """\
      - uses: actions/setup-python@5fda3b95a4ea91299a34e894583c3862153e4b97 # v7.0.0
        with:
          python-version: "3.12"
      - shell: bash
        working-directory: ${{{{ runner.temp }}}}
        env:
          URDFCHECK: {install}
        run: |
          python -I -m venv urdfcheck
          urdfcheck/bin/python -I -m pip install --quiet "$URDFCHECK"
      - shell: bash
        env:
          CHECKED: {folder}
          FROM: ${{{{ github.event_name == 'push' && github.repository || github.event.pull_request.head.repo.full_name }}}}
        run: |
          isolated=--isolated # the configuration of another repository is a stranger's
          if [ "$FROM" = "$GITHUB_REPOSITORY" ]; then isolated=""; fi
          "$RUNNER_TEMP/urdfcheck/bin/python" -I -m urdfcheck check $isolated \\
            --format github -o html="$RUNNER_TEMP/urdfcheck.html" -- "$CHECKED"
      - uses: actions/upload-artifact@bbbca2ddaa5d8feaa63e36b76fdaad77386f024f # v7.0.0
        if: always()
        with:
          path: ${{{{ runner.temp }}}}/urdfcheck.html
          archive: false
"""
GITLAB_JOB = """\
urdfcheck:
  image: python:3.12
{stage}  script:
    - |
      own="$(mktemp -d)"
      python -I -m venv "$own/python"
      URDFCHECK={install}
      (cd "$own" && python/bin/python -I -m pip install --quiet "$URDFCHECK")
    - |
      isolated=--isolated # the configuration of another project is a stranger's
      case "${{CI_PIPELINE_SOURCE:-}}" in
        push|schedule|web) isolated="" ;;
      esac
      if [ "${{CI_MERGE_REQUEST_SOURCE_PROJECT_ID:-}}" = "${{CI_MERGE_REQUEST_PROJECT_ID:-none}}" ]; then isolated=""; fi
    - |
      "$own/python/bin/python" -I -m urdfcheck check $isolated -o gitlab=urdfcheck.codequality.json \\
        -o junit=urdfcheck.junit.xml -o html=urdfcheck.html -- {folder}
  artifacts:
    when: always
    expose_as: urdfcheck report
    paths: [urdfcheck.html]
    reports:
      codequality: urdfcheck.codequality.json
      junit: urdfcheck.junit.xml
"""
# Without a repository that has the hooks. What stands in braces is how they are run.
_OWN_HOOKS = """\
- repo: local # {note}
  hooks:
    - id: urdfcheck
      name: urdfcheck
      {entry}
      types_or: [urdf, xacro]
      require_serial: true
    - id: urdfcheck-meshes
      name: urdfcheck (models of changed meshes, launch files and settings)
      {entry}
      files: |
        (?xi)(
          \\.(stl|dae|obj|ply|off|glb|gltf|bin|srdf)
          |\\.launch|[._]launch\\.(xml|py)
          |(^|/)package\\.xml
          |(^|/)(config|params|controllers|control|launch)/.*\\.ya?ml
        )$
      require_serial: true
"""
LOCAL_HOOKS = _OWN_HOOKS.format(
    note="runs the urdfcheck that is installed; with an address: repo, rev, and only the two ids",
    entry="entry: urdfcheck --allow-empty\n      language: system",
)
PINNED_HOOKS = _OWN_HOOKS.replace(
    "{entry}",
    "entry: python -I -m urdfcheck --allow-empty\n"
    "      language: python\n"
    "      additional_dependencies: [{requirement}]",
).replace("{note}", "pre-commit installs this version by itself")
HOOKS = """\
- repo: {address}
  rev: {revision}
  hooks:
    - id: urdfcheck # changed URDF and xacro files
    - id: urdfcheck-meshes # models of changed meshes, launch files and settings
"""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck init``."""
    p = CommandParser(
        prog="urdfcheck init",
        description="Write a configuration, a pre-commit entry and a CI job for the models in a folder. Nothing that is there is "
        "overwritten: text is added to it, or it is left as it is.",
    )
    p.add_argument(
        "folder", nargs="?", default=".", metavar="FOLDER", help="where the models are (default: this folder)"
    )
    p.add_argument(
        "--vscode",
        action="store_true",
        help="also write a task that lists findings as problems, the settings and the JSON Schema of the configuration",
    )
    p.add_argument(
        "--ament",
        action="store_true",
        help="also give each package of ament the test of urdfcheck, for which ament_urdfcheck must be in the workspace",
    )
    p.add_argument("--dry-run", action="store_true", help="write nothing, and print what would be written")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    folder = Path(options.folder)
    if not folder.is_dir():
        raise UrdfcheckError(f"{folder} is not a folder")
    root = _find_repository(folder)
    inside = Path(os.path.relpath(folder.resolve(), root)).as_posix()
    _ensure_writable_name(inside)

    outcome = _expand_models(folder)
    if not outcome.models:
        say(f"no model was found in {folder}: there is nothing to set up")
        return NOTHING
    origin = find_install_origin()
    install = origin.requirement or UNKNOWN
    action = _format_github_action(origin.address, origin.revision)
    needing = _collect_needed_arguments(outcome, folder)
    steps = [
        _plan_configuration(folder, needing, _list_expanded_by_launch(outcome)),
        _plan_hooks(root / PRE_COMMIT, format_hooks(origin)),
        _plan_job(root, install, action=action, folder=inside),
    ]
    tested = _plan_ament(outcome, folder) if options.ament else []
    more = [*(_plan_vscode(root, inside) if options.vscode else []), *tested]
    _report_found(outcome)
    for step in (*steps, *more):
        _run_step(step, root, dry=options.dry_run)
    failed = any(info.status == "failed" for info in outcome.models)
    needs_packages = any(step.text is not None for step in tested)
    if not options.dry_run:
        _report_next_steps(steps, needing, known=bool(origin.requirement), failed=failed, needs_packages=needs_packages)
    return OK


def _ensure_writable_name(name: str) -> None:
    """Reject a folder whose name a CI service would not take as text: it may be a stranger's.

    :raises UrdfcheckError: for a line break, a tab or another invisible character, and for an expression of GitHub, which is
        evaluated anywhere in a workflow.
    """
    if not name.isprintable():
        raise UrdfcheckError(f"{name}: the name has a character that no line of a CI job can hold; rename the folder")
    if "${{" in name:
        raise UrdfcheckError(f"{name}: GitHub would evaluate what follows ${{{{ in the name; rename the folder")


# -- what is there -----------------------------------------------------------------------------------------------------


def _expand_models(folder: Path) -> Run:
    """Expand the models of a folder, to find those that need arguments."""
    from urdfcheck.policy.config_resolver import make_default_config
    from urdfcheck.policy.policy import Policy
    from urdfcheck.run.jobs import Request
    from urdfcheck.run.pipeline import Execution, run
    from urdfcheck.system import libraries

    libraries.prefer_own_folders()
    request = Request(
        paths=(folder,),
        root=make_default_config(folder).root,
        policy=Policy(codes=frozenset({"XAC010"}), tier="source"),
        jobs=os.cpu_count() or 1,
    )
    return run(request, Execution(on_progress=make_progress_printer()))


def _collect_needed_arguments(outcome: Run, folder: Path) -> dict[Path, dict[str, tuple[str, ...]]]:
    """Collect the models that need arguments, with the names of these and the values that the text of the model gives."""
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach
    from urdfcheck.source.xacro.argument_values import find_argument_choices

    lacking = {info.id: info for info in outcome.models if info.status == "needs-arguments"}
    needed: dict[Path, dict[str, tuple[str, ...]]] = {}
    for finding in outcome.findings:
        info = lacking.get(finding.model)
        if info is not None:
            path = Path(info.path)
            finder = PackageFinder(path.absolute(), reach=FileReach.from_paths([folder], []))
            known = {choice.name: choice.values for choice in find_argument_choices(path, finder)}
            names = [str(name) for name in finding.data["missing"]]
            passed = {name: (info.args[name],) for name in info.found_args}
            needed.setdefault(path, {}).update({**passed, **{name: known.get(name, ()) for name in names}})
    return needed


def _list_expanded_by_launch(outcome: Run) -> list[ModelInfo]:
    """Return the models that could be expanded because launch files pass arguments to them."""
    return [info for info in outcome.models if info.found_args and info.status == "checked"]


def _find_repository(folder: Path) -> Path:
    """Return the work tree around a folder, where CI and pre-commit look; the folder itself outside one."""
    real = folder.resolve()
    return next((f for f in (real, *real.parents) if (f / ".git").exists()), real)


# -- what is to be written ---------------------------------------------------------------------------------------------


def format_hooks(origin: InstallOrigin) -> str:
    """Return the entry for pre-commit: the hooks of the repository, the version of the index, or what is installed here."""
    if origin.address:
        return HOOKS.format(address=origin.address, revision=origin.revision)
    return PINNED_HOOKS.format(requirement=_quote_yaml(origin.requirement)) if origin.requirement else LOCAL_HOOKS


def _plan_configuration(
    folder: Path, needing: Mapping[Path, Mapping[str, Sequence[str]]], found: Sequence[ModelInfo]
) -> SetupStep:
    import tomli

    own, project = folder / "urdfcheck.toml", folder / "pyproject.toml"
    if own.exists():
        return SetupStep(path=own, verb="kept", reason="it is there already")
    if not project.is_file():
        text = CONFIGURATION.format(table="", prefix="") + _format_models(needing, found, folder, "")
        return SetupStep(path=own, verb="wrote", text=text, added=text)
    before = _read_text(project)
    table, prefix = "[tool.urdfcheck]\n", "tool.urdfcheck."
    added = CONFIGURATION.format(table=table, prefix=prefix) + _format_models(needing, found, folder, prefix)
    try:
        if "urdfcheck" in tomli.loads(before).get("tool", {}):
            return SetupStep(path=project, verb="kept", reason="it has a table [tool.urdfcheck] already")
        text = _append_text(before, added)
        tomli.loads(text)
    except (tomli.TOMLDecodeError, AttributeError, TypeError):
        return SetupStep(
            path=project,
            verb="kept",
            reason="nothing can be added to it: put what follows in urdfcheck.toml",
            added=added,
        )
    return SetupStep(path=project, verb="extended", text=text, added=added)


def _format_models(
    needing: Mapping[Path, Mapping[str, Sequence[str]]], found: Sequence[ModelInfo], folder: Path, prefix: str
) -> str:
    """Return the tables of models: those that launch files pass arguments to, then those that still need some."""
    entries = []
    for info in found:
        values = ", ".join(f"{_format_toml_key(n)} = {_quote_toml(info.args[n])}" for n in sorted(info.found_args))
        places = "".join(
            f"# {_format_toml_key(n)}: {_quote_toml(place)}\n" for n, place in sorted(info.found_args.items())
        )
        entries.append(
            f"\n[[{prefix}models]]                       # as launch files start it\n"
            f"path = {_quote_toml(_format_relative_path(Path(info.path), folder))}\n"
            f"arguments = {{ {values} }}\n{places}"
        )
    for path, arguments in sorted(needing.items()):
        relative = _format_relative_path(path, folder)
        values = ", ".join(
            f"{_format_toml_key(n)} = {_quote_toml(known[0] if known else '')}" for n, known in arguments.items()
        )
        notes = [
            f"# {_format_toml_key(name)}: {', '.join(map(_quote_toml, known))}\n"
            for name, known in arguments.items()
            if known
        ]
        entries.append(
            f"\n[[{prefix}models]]                       # it cannot be expanded without these arguments\n"
            f"path = {_quote_toml(relative)}\n# arguments = {{ {values} }}\n{''.join(notes)}"
        )
    return "".join(entries)


def _format_relative_path(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()


def _quote_toml(text: str) -> str:
    # A JSON string is a TOML string, except for DEL, and for surrogates, in pairs or alone.
    escaped = json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
    return "".join(c if c.isprintable() else _escape_character(c) for c in escaped)


def _escape_character(character: str) -> str:
    """Return the escape of an invisible character for TOML; a byte that is not UTF-8 has none, and is replaced."""
    if "\ud800" <= character <= "\udfff":
        return "\ufffd"
    return f"\\U{ord(character):08x}"


def _quote_yaml(text: str) -> str:
    """Return a printable text as YAML takes it whatever it holds: a double-quoted scalar."""
    return json.dumps(text, ensure_ascii=False)


def _format_toml_key(name: str) -> str:
    return name if name.replace("_", "").replace("-", "").isalnum() and name.isascii() else _quote_toml(name)


def _plan_hooks(path: Path, entry: str) -> SetupStep:
    if not path.exists():
        text = "repos:\n" + _indent_lines(entry, 2)
        return SetupStep(path=path, verb="wrote", text=text, added=text)
    before = _read_text(path)
    if "urdfcheck" in before:
        return SetupStep(path=path, verb="kept", reason="it names urdfcheck already")
    after = add_hooks(before, entry)
    if after is None:
        return SetupStep(
            path=path,
            verb="kept",
            reason="its list of repos is not one that text can be added to: add what follows",
            added=entry,
        )
    return SetupStep(path=path, verb="extended", text=after, added=entry)


def add_hooks(before: str, entry: str) -> str | None:
    """Add an entry at the end of the repos of a pre-commit configuration; every other byte stays as it is.

    Returns None where the result would not parse to the old content with the new entry.
    """
    import yaml

    try:
        tree = _compose_yaml(before)
        pairs = tree.value if isinstance(tree, yaml.MappingNode) else []
        repos = next((value for key, value in pairs if key.value == "repos"), None)
        if not isinstance(repos, yaml.SequenceNode) or repos.flow_style or not repos.value:
            return None
        node: Any = repos
        while isinstance(node, (yaml.SequenceNode, yaml.MappingNode)) and node.value and not node.flow_style:
            last = node.value[-1]
            node = last if isinstance(node, yaml.SequenceNode) else last[1]
        end = node.end_mark.index
        if node.end_mark.column:
            newline = before.find("\n", end)
            end = len(before) if newline < 0 else newline + 1
        text = _append_text(before[:end], _indent_lines(entry, repos.start_mark.column), blank=False) + before[end:]
        meant = yaml.safe_load(before)
        meant["repos"].extend(yaml.safe_load(entry))
        return text if yaml.safe_load(text) == meant else None
    except (yaml.YAMLError, AttributeError, TypeError, ValueError):
        return None


def _compose_yaml(text: str) -> Any:
    """Return the nodes of a file of the repository, which may be a stranger's; None beyond the limits on their number and depth,
    and for text that is not yaml."""
    import yaml

    from urdfcheck.source.text.xml import SourceFile
    from urdfcheck.source.text.yaml.reader import compose_nodes
    from urdfcheck.source.text.yaml.values import YamlReadError

    try:
        return compose_nodes(SourceFile(Path(), "", text=text))
    except (yaml.YAMLError, YamlReadError):
        return None


def _format_github_action(address: str, revision: str) -> str:
    """Return how a GitHub workflow names the action at an address; empty for an address outside GitHub."""
    match = re.fullmatch(r"https://github\.com/([\w.-]+/[\w.-]+?)(?:\.git)?/?", address)
    return "" if match is None else f"{match.group(1)}@{revision}"


def _plan_job(root: Path, install: str, *, action: str, folder: str) -> SetupStep:
    if not (root / GITLAB).exists():
        path = root / GITHUB
        if path.exists():
            return SetupStep(path=path, verb="kept", reason="it is there already")
        note = f" # {_WHAT_TO_INSTALL}" if install == UNKNOWN else ""
        steps = (
            ACTION.format(action=action, folder=_quote_yaml(folder))
            if action
            else INSTALLED.format(install=_quote_yaml(install) + note, folder=_quote_yaml(folder))
        )
        text = JOB.format(steps=steps)
        return SetupStep(path=path, verb="wrote", text=text, added=text)
    import yaml

    path = root / GITLAB
    before = _read_text(path)
    if "urdfcheck" in before:
        return SetupStep(path=path, verb="kept", reason="it names urdfcheck already")
    tree = _compose_yaml(before)
    pairs = tree.value if isinstance(tree, yaml.MappingNode) else []
    declared = next((value for key, value in pairs if key.value == "stages"), None)
    stages = [str(stage.value) for stage in declared.value] if isinstance(declared, yaml.SequenceNode) else ["test"]
    is_needed = stages and "test" not in stages and stages[0].isprintable()
    stage = f"  stage: {_quote_yaml(stages[0])}\n" if is_needed else ""
    note = f" # {_WHAT_TO_INSTALL}" if install == UNKNOWN else ""
    job = GITLAB_JOB.format(stage=stage, install=shlex.quote(install) + note, folder=shlex.quote(folder))
    if tree is None or not isinstance(tree, yaml.MappingNode) or tree.flow_style:
        return SetupStep(path=path, verb="kept", reason="it cannot be added to: add what follows", added=job)
    return SetupStep(path=path, verb="extended", text=_append_text(before, job), added=job)


def _plan_vscode(root: Path, folder: str) -> list[SetupStep]:
    from urdfcheck.cli.vscode_files import SCHEMA, render_vscode_files

    steps = []
    for name, text in render_vscode_files(folder).items():
        shown = f"the JSON Schema of urdfcheck.toml, {len(text) // 1000} kB" if name == SCHEMA else text
        path = root / name
        if not path.exists():
            steps.append(SetupStep(path=path, verb="wrote", text=text, added=shown))
        elif name == SCHEMA or "urdfcheck" in _read_text(path):
            steps.append(SetupStep(path=path, verb="kept", reason="it is there already"))
        else:
            reason = "it may have comments, which would be lost: add what follows"
            steps.append(SetupStep(path=path, verb="kept", reason=reason, added=text))
    return steps


def _plan_ament(outcome: Run, folder: Path) -> list[SetupStep]:
    """Plan the tests of the packages that have the models."""
    from urdfcheck.cli.ament_files import plan_ament_files
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.reach import FileReach

    packages = {}
    for info in outcome.models:
        path = Path(info.path).absolute()
        package = PackageFinder(path, reach=FileReach.from_paths([folder], [])).find_package_of(path)
        if package is not None:
            packages[package.path] = package
    return [step for _, package in sorted(packages.items()) for step in plan_ament_files(package)]


def _append_text(before: str, added: str, *, blank: bool = True) -> str:
    """Append a text to another, with the line ends of the latter."""
    newline = "\r\n" if "\r\n" in before else "\n"
    end = "" if not before or before.endswith("\n") else newline
    return before + end + (newline if blank and before.strip() else "") + added.replace("\n", newline)


def _indent_lines(text: str, columns: int) -> str:
    return "".join(" " * columns + line for line in text.splitlines(keepends=True))


def _read_text(path: Path) -> str:
    from urdfcheck.system.files import read_regular

    try:
        return read_regular(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UrdfcheckError(f"{path}: {error}") from None


# -- writing and reporting ----------------------------------------------------------------------------------------------


def _run_step(step: SetupStep, root: Path, *, dry: bool) -> None:
    from urdfcheck.source.package.finder import format_path

    name = format_path(step.path)
    text = step.text
    real = Path(os.path.realpath(step.path))
    if text is not None and (step.path.is_symlink() or not real.is_relative_to(root)):
        text = None
        step = SetupStep(path=step.path, verb="kept", reason="it is a link, or outside the repository")
    if text is None:
        say(f"  kept      {name}: {step.reason}")
        if step.added:
            say(_indent_lines(step.added, 6).rstrip())
        return
    if dry:
        say(
            f"  {'would write' if step.verb == 'wrote' else 'would add to'} {name}:\n{_indent_lines(step.added, 6).rstrip()}"
        )
        return
    write_file(text, step.path, CheckedFolders.around([root]))
    say(f"  {step.verb:<9} {name}")


def _report_found(outcome: Run) -> None:
    number = len(outcome.models)
    needing = sum(info.status == "needs-arguments" for info in outcome.models)
    failed = sum(info.status == "failed" for info in outcome.models)
    notes = [f"{needing} {'needs' if needing == 1 else 'need'} arguments"] if needing else []
    notes += [f"{failed} cannot be expanded"] if failed else []
    say(f"found {number} {'model' if number == 1 else 'models'}{''.join(', ' + note for note in notes)}")


def _report_next_steps(
    steps: Sequence[SetupStep],
    needing: Mapping[Path, object],
    *,
    known: bool,
    failed: bool,
    needs_packages: bool,
) -> None:
    from urdfcheck.source.package.finder import format_path

    configuration, hooks, job = steps
    steps_left = []
    if needing and configuration.text is not None:
        steps_left.append(
            f"give {', '.join(map(format_path, sorted(needing)))} arguments in {format_path(configuration.path)}"
        )
    if not known and (job.text is not None or (job.path.is_file() and UNKNOWN in _read_text(job.path))):
        steps_left.append(
            f"write in {format_path(job.path)} how urdfcheck is installed ({UNKNOWN}): {_WHAT_TO_INSTALL}"
        )
    if hooks.text is not None:
        steps_left.append("pre-commit install           the hook runs at each commit")
    if needs_packages:
        steps_left.append(
            "colcon test                  needs ament_urdfcheck and ament_cmake_urdfcheck in the workspace: "
            "copy integrations/ament of urdfcheck"
        )
    steps_left.append("urdfcheck .                  what is wrong today")
    if failed:
        steps_left.append(
            f"unchecked = [PATTERNS]       in {format_path(configuration.path)} accepts models that cannot be expanded; "
            "a baseline does not"
        )
    steps_left.append("urdfcheck baseline write     after that, only new findings are reported")
    say("next")
    for line in steps_left:
        say(f"  {line}")
