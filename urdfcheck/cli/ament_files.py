"""The lines with which ``colcon test`` checks the robots of a package: a dependency, and the test where it needs one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.cli.setup_step import SetupStep

if TYPE_CHECKING:
    from urdfcheck.source.package.finder import Package

# What the test of a package depends on, by its build type.
_NEEDED = {"ament_cmake": "ament_cmake_urdfcheck", "ament_python": "ament_urdfcheck"}
# The linters of a package that calls this are those that package.xml names.
_FINDS_LINTERS = "ament_lint_auto_find_test_dependencies"
_CMAKE_TEST = """\
if(BUILD_TESTING)
  find_package(ament_cmake_urdfcheck REQUIRED)
  ament_urdfcheck()
endif()

"""
_PYTHON_TEST = '''\
"""The robot models of this package are checked by urdfcheck."""

from ament_urdfcheck.main import main


def test_urdfcheck():
    assert main(["."]) == 0
'''


def plan_ament_files(package: Package) -> Iterator[SetupStep]:
    """Yield what happens to the files of a package; nothing but its reason where it has no test that could be added."""
    from urdfcheck.source.package.build_files import read_build_type

    manifest = package.path / "package.xml"
    build = read_build_type(package.root)
    needed = _NEEDED.get(build)
    if needed is None or package.file is None:
        yield SetupStep(path=manifest, verb="kept", reason=f"its build type is not {' or '.join(_NEEDED)}")
    elif needed in package.dependencies:
        yield SetupStep(path=manifest, verb="kept", reason=f"it depends on {needed} already")
    else:
        yield _plan_dependency(package, f"<test_depend>{needed}</test_depend>")
        yield from _plan_cmake_test(package) if build == "ament_cmake" else _plan_python_test(package)


def _plan_dependency(package: Package, line: str) -> SetupStep:
    """Plan the line after the last dependency of a manifest, or before what it exports."""
    assert package.root is not None
    assert package.file is not None
    text, manifest = package.file.text, package.path / "package.xml"
    last = next(
        (child for child in reversed(package.root.children) if child.tag.endswith("depend") and child.text.strip()),
        None,
    )
    if last is None or last.span is None:
        return SetupStep(path=manifest, verb="kept", reason="it has no dependency: add what follows", added=f"{line}\n")
    end = text.index(">", text.index("</", last.span.start)) + 1
    begin = text.rfind("\n", 0, last.span.start) + 1
    indent = text[begin : last.span.start]
    added = f"{_find_newline(text)}{indent if not indent.strip() else ''}{line}"
    return SetupStep(path=manifest, verb="extended", text=text[:end] + added + text[end:], added=f"{line}\n")


def _plan_cmake_test(package: Package) -> Iterator[SetupStep]:
    from urdfcheck.source.package.cmake_installs import parse_commands
    from urdfcheck.system.files import read_regular

    path = package.path / "CMakeLists.txt"
    try:
        text = read_regular(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        yield SetupStep(path=path, verb="kept", reason=str(error))
        return
    commands = [*parse_commands(text)]
    if any(command.name in {_FINDS_LINTERS, "ament_auto_find_test_dependencies"} for command in commands):
        return
    last = next((c for c in reversed(commands) if c.name in {"ament_package", "ament_auto_package"}), None)
    if last is None:
        reason = "it does not call ament_package(): add what follows"
        yield SetupStep(path=path, verb="kept", reason=reason, added=_CMAKE_TEST)
        return
    added = _CMAKE_TEST.replace("\n", _find_newline(text))
    yield SetupStep(path=path, verb="extended", text=text[: last.start] + added + text[last.start :], added=_CMAKE_TEST)


def _plan_python_test(package: Package) -> Iterator[SetupStep]:
    path = package.path / "test" / "test_urdfcheck.py"
    if not path.exists():
        yield SetupStep(path=path, verb="wrote", text=_PYTHON_TEST, added=_PYTHON_TEST)


def _find_newline(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"
