"""What a package's build installs is read from its build file, and a path is followed from there back to the source."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest

from urdfcheck.source.package.build_files import read_installed_files
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.installed_files import InstalledFiles

FOR_SHARE = "DESTINATION share/${PROJECT_NAME}"


def read_cmake(text: str) -> InstalledFiles:
    installed = read_installed_files("p", "ament_cmake", {"CMakeLists.txt": f"project(p)\n{text}\n"}.get)
    assert installed is not None
    return installed


def read_setup(text: str) -> InstalledFiles | None:
    return read_installed_files("p", "ament_python", {"setup.py": text}.get)


@pytest.mark.parametrize(
    ("cmake", "path", "source"),
    [
        (f"install(DIRECTORY urdf {FOR_SHARE})", "urdf/a.urdf", "urdf/a.urdf"),
        (f"install(DIRECTORY description/urdf {FOR_SHARE})", "urdf/a.urdf", "description/urdf/a.urdf"),
        (f"install(DIRECTORY description/urdf/ {FOR_SHARE})", "a.urdf", "description/urdf/a.urdf"),
        (f"install(DIRECTORY description/urdf/ {FOR_SHARE}/urdf)", "urdf/x/a.urdf", "description/urdf/x/a.urdf"),
        (f"install(DIRECTORY description/urdf {FOR_SHARE})", "description/urdf/a.urdf", None),
        (f'add_definitions(-DROOT=\\"a/\\")\ninstall(DIRECTORY urdf {FOR_SHARE})', "urdf/a.urdf", "urdf/a.urdf"),
        ("install(DIRECTORY a/urdf DESTINATION share/p/)", "urdf/a.urdf", "a/urdf/a.urdf"),
        ("install(DIRECTORY a/urdf DESTINATION share/other)", "urdf/a.urdf", None),
        # a tree that is already as the install prefix has it
        ("install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/share/ DESTINATION share)", "urdf/a", "share/p/urdf/a"),
        ("install(DIRECTORY share/ DESTINATION ${CMAKE_INSTALL_DATAROOTDIR})", "urdf/a", "share/p/urdf/a"),
        ("install(DIRECTORY x/share DESTINATION .)", "urdf/a", "x/share/p/urdf/a"),
        ("install(DIRECTORY x/p DESTINATION ${CMAKE_INSTALL_DATADIR})", "urdf/a", "x/p/urdf/a"),
        ("install(DIRECTORY x/other DESTINATION share)", "urdf/a", None),
        ("install(DIRECTORY share/ DESTINATION lib)", "urdf/a", None),
        ("install(DIRECTORY share/ DESTINATION ${UNKNOWN}/share)", "urdf/a", None),
        ("install(DIRECTORY a/urdf DESTINATION include)", "urdf/a.urdf", None),
        ("install(DIRECTORY a/urdf DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})", "urdf/a", "a/urdf/a"),
        ("install(DIRECTORY a/urdf DESTINATION ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})", "urdf/a", "a/urdf/a"),
        ("install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/a/urdf DESTINATION share/p)", "urdf/a", "a/urdf/a"),
        ('install(DIRECTORY a/urdf DESTINATION share/p PATTERN "*.in" EXCLUDE)', "urdf/a.in", None),
        ('install(DIRECTORY a/urdf DESTINATION share/p PATTERN "*.in" EXCLUDE)', "urdf/a.urdf", "a/urdf/a.urdf"),
        ("install(DIRECTORY a/urdf DESTINATION share/p PATTERN old EXCLUDE)", "urdf/old/a.urdf", None),
        ('install(DIRECTORY a/m DESTINATION share/p FILES_MATCHING PATTERN "*.stl")', "m/a.stl", "a/m/a.stl"),
        ('install(DIRECTORY a/m DESTINATION share/p FILES_MATCHING PATTERN "*.stl")', "m/a.dae", None),
        ("install(FILES a/x.urdf b/y.urdf DESTINATION share/p/urdf)", "urdf/y.urdf", "b/y.urdf"),
        ("install(FILES a/x.urdf DESTINATION share/p/urdf RENAME z.urdf)", "urdf/z.urdf", "a/x.urdf"),
        ("install(FILES a/x.urdf DESTINATION share/p/urdf RENAME z.urdf)", "urdf/x.urdf", None),
        ("install(PROGRAMS a/x.py DESTINATION lib/p)", "x.py", None),
        ("file(GLOB fs a/*.urdf)\ninstall(FILES ${fs} DESTINATION share/p/urdf)", "urdf/z.urdf", "a/z.urdf"),
        ("file(GLOB fs a/*.urdf)\ninstall(FILES ${fs} DESTINATION share/p/urdf)", "urdf/z.yaml", None),
        ("foreach(d a b)\ninstall(DIRECTORY x/${d}/ DESTINATION share/p/${d})\nendforeach()", "b/f", "x/b/f"),
        ("ament_auto_package(INSTALL_TO_SHARE x/launch config)", "launch/f", "x/launch/f"),
        # what the build makes out of a xacro file stands for that file
        ("xacro_add_files(x/a.urdf.xacro TARGET t INSTALL DESTINATION urdf)", "urdf/a.urdf", "x/a.urdf.xacro"),
        ("xacro_add_files(x/a.urdf.xacro TARGET t INSTALL DESTINATION urdf)", "urdf/a.urdf.xacro", None),
        ("set(fs a.xacro)\nxacro_add_files(${fs} REMAP b:=1 INSTALL)", "a", "a.xacro"),
        ("xacro_add_files(x/a.urdf.xacro TARGET t)", "urdf/a.urdf", None),
        (f"# install(DIRECTORY description/urdf {FOR_SHARE})", "urdf/a.urdf", None),
        # a path that leaves a folder begins where the folder's files are installed
        (f"install(DIRECTORY a/urdf b/parts {FOR_SHARE})", "a/urdf/../parts/w.xacro", "b/parts/w.xacro"),
        (f"install(DIRECTORY a/urdf b/parts {FOR_SHARE})", "a/urdf/../../parts/w.xacro", None),
        (f"install(DIRECTORY a/urdf b/parts {FOR_SHARE})", "urdf/../parts/w.xacro", "b/parts/w.xacro"),
        (f"install(DIRECTORY . {FOR_SHARE})", "urdf/a.urdf", "urdf/a.urdf"),
        (f"install(DIRECTORY ../other/urdf {FOR_SHARE})", "urdf/a.urdf", None),
        (f"install(DIRECTORY /etc {FOR_SHARE})", "etc/passwd", None),
    ],
)
def test_what_cmake_puts_at_a_place(cmake: str, path: str, source: str | None) -> None:
    assert next(read_cmake(cmake).resolve_path(path), None) == source


SUBDIRECTORY = {
    "CMakeLists.txt": "project(p)\nset(kind meshes)\n{}\ninstall(DIRECTORY late DESTINATION share/p)\n",
    "description/CMakeLists.txt": "set(kind urdf)\ninstall(DIRECTORY ${kind} DESTINATION share/p)\n"
    "install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/m DESTINATION share/${PROJECT_NAME})\n"
    "install(DIRECTORY ${CMAKE_SOURCE_DIR}/top DESTINATION share/p)\nfile(GLOB all *.yaml)\n"
    "install(FILES ${all} DESTINATION share/p/config)\ninstall(DIRECTORY . DESTINATION share/p/copy)\nadd_subdirectory(inner)",
    "description/inner/CMakeLists.txt": "install(DIRECTORY ../beside deep DESTINATION share/p)",
    "cmake/all.cmake": "install(DIRECTORY ${kind} DESTINATION share/p)\ninclude(${CMAKE_CURRENT_LIST_DIR}/more.cmake)",
    "cmake/more.cmake": "install(DIRECTORY config DESTINATION share/p)",
    "loop/CMakeLists.txt": "add_subdirectory(.)\nadd_subdirectory(.)",
}


@pytest.mark.parametrize(
    ("command", "path", "source"),
    [
        ("add_subdirectory(description)", "urdf/a", "description/urdf/a"),
        ("add_subdirectory(description)", "m/a", "description/m/a"),
        ("add_subdirectory(description)", "top/a", "top/a"),
        ("add_subdirectory(description)", "config/a.yaml", "description/a.yaml"),
        ("add_subdirectory(description)", "copy/x/a", "description/x/a"),
        ("add_subdirectory(description)", "beside/a", "description/beside/a"),
        ("add_subdirectory(description)", "deep/a", "description/inner/deep/a"),
        ("add_subdirectory(${CMAKE_CURRENT_SOURCE_DIR}/description)", "urdf/a", "description/urdf/a"),
        ("add_subdirectory(description EXCLUDE_FROM_ALL)", "urdf/a", None),
        ("foreach(d description)\nadd_subdirectory(${d})\nendforeach()", "urdf/a", "description/urdf/a"),
        ("include(cmake/all.cmake)", "meshes/a", "meshes/a"),
        ("include(cmake/all.cmake)", "config/a", "config/a"),
        ("add_subdirectory(description)\ninstall(DIRECTORY ${kind} DESTINATION share/p)", "meshes/a", "meshes/a"),
        ("add_subdirectory(loop)", "late/a", None),
        ("add_subdirectory(description)", "late/a", "late/a"),
    ],
)
def test_what_files_that_cmake_includes_put_at_a_place(command: str, path: str, source: str | None) -> None:
    files = {**SUBDIRECTORY, "CMakeLists.txt": SUBDIRECTORY["CMakeLists.txt"].format(command)}
    installed = read_installed_files("p", "ament_cmake", files.get)
    assert installed is not None
    assert next(installed.resolve_path(path), None) == source
    is_known = "EXCLUDE" not in command and "loop" not in command
    assert installed.is_complete is is_known


@pytest.mark.parametrize(
    "command",
    [
        "add_subdirectory(absent)",
        "add_subdirectory(../other)",
        "include(CTest)",
        "include(/etc/passwd)",
        "include(${x})",
    ],
)
def test_files_that_are_not_in_the_package_install_nobody_knows_what(command: str) -> None:
    opened: list[str] = []

    def read_text(name: str) -> str | None:
        opened.append(name)
        return command if name == "CMakeLists.txt" else None

    installed = read_installed_files("p", "ament_cmake", read_text)
    assert installed is not None
    assert not installed.is_complete
    assert not [name for name in opened if name.startswith(("/", ".."))]


HELPER = """
import os
package_name = 'p'
def package_files(data_files, directory_list):
    paths_dict = {}
    for directory in directory_list:
        for (path, directories, filenames) in os.walk(directory):
            for filename in filenames:
                file_path = os.path.join(path, filename)
                install_path = os.path.join('share', package_name, path)
                if install_path in paths_dict.keys():
                    paths_dict[install_path].append(file_path)
                else:
                    paths_dict[install_path] = [file_path]
    for key in paths_dict.keys():
        data_files.append((key, paths_dict[key]))
    return data_files
data_files = [('share/' + package_name, ['package.xml'])]
setup(name=package_name, data_files=package_files(data_files, ['meshes/', 'launch/']))
"""
LOOP = """
files = [(f'share/{name}', ['package.xml'])]
for folder in ('launch', 'config'):
    files.append((os.path.join('share', name, folder), glob(os.path.join('ros2', folder, '*.*'))))
setup(data_files=files)
"""
WALK = """
def tree(root):
    return [(os.path.join('share', 'p', d), [os.path.join(d, f) for f in files]) for d, _, files in os.walk(root)]
setup(data_files=[('share/p', ['package.xml']), *tree('meshes')])
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "cmake",
    [
        pytest.param("foreach(a x)\n" * 3_000 + "endforeach()\n" * 3_000, id="loops in loops"),
        pytest.param("foreach(a x)\n" * 20_000, id="loops without an end"),
        pytest.param("set(v a)\n" + "set(v ${v}${v})\n" * 60 + "install(FILES ${v} DESTINATION share/p)", id="doubled"),
        pytest.param("set(v a b)\n" + 'set(v "${v}${v}")\n' * 60, id="doubled texts"),
        pytest.param("set(v " + "a" * 99_000 + ")\nset(w" + " ${v}" * 2_000 + ")\nset(x ${w})" * 2_000, id="copied"),
    ],
)
def test_what_grows_without_bound_counts_as_unknown(cmake: str) -> None:
    tracemalloc.start()
    try:
        installed = read_cmake(f"{cmake}\ninstall(DIRECTORY ${{v}} DESTINATION share/p)")
        assert tracemalloc.get_traced_memory()[1] < 200_000_000
    finally:
        tracemalloc.stop()
    assert not installed.is_complete


@pytest.mark.parametrize(
    ("setup", "path", "source"),
    [
        ("setup(data_files=[('share/p/urdf', ['a/x.urdf'])])", "urdf/x.urdf", "a/x.urdf"),
        ("setup(data_files=[('share/p/urdf', glob('a/*.urdf'))])", "urdf/x.urdf", "a/x.urdf"),
        ("setup(data_files=[('share/p/urdf', glob('a/*.urdf'))])", "urdf/x.xacro", None),
        ("n = 'p'\nsetup(data_files=[(os.path.join('share', n, 'u'), glob.glob('a/*'))])", "u/x", "a/x"),
        ("n = 'p'\nsetup(data_files=[('share/' + n + '/u', [str(Path('a') / 'x')])])", "u/x", "a/x"),
        ("setup(data_files=[('share/p/u', [f for f in glob('a/*') if isfile(f)])])", "u/x", "a/x"),
        ("setup(data_files=[('lib/p', ['a/x'])])", "x", None),
        ("setup(data_files=[('share/p', ['/etc/passwd'])])", "passwd", None),
        ("setup(data_files=[('share/p', ['../x'])])", "x", None),
        (HELPER, "meshes/visual/base.stl", "meshes/visual/base.stl"),
        (HELPER, "package.xml", "package.xml"),
        (HELPER, "urdf/a.urdf", None),
        (f"name = 'p'{LOOP}", "config/a.yaml", "ros2/config/a.yaml"),
        (WALK, "meshes/a/b.stl", "meshes/a/b.stl"),
    ],
)
def test_what_setup_py_puts_at_a_place(setup: str, path: str, source: str | None) -> None:
    installed = read_setup(setup)
    assert installed is not None
    assert next(installed.resolve_path(path), None) == source


@pytest.mark.parametrize(
    ("setup", "complete"),
    [
        (HELPER, True),
        (f"name = 'p'{LOOP}", True),
        (WALK, True),
        (f"name = read()\n{LOOP}", False),
        ("setup(data_files=[('share/p', ['a'])] + more())", False),
        ("def f(d):\n    if not isdir(d):\n        return []\n    return [('share/p', [d])]\nsetup(data_files=f('a'))", False),
        ("d = []\nwhile d_next():\n    d.append(1)\nsetup(data_files=d)", False),
        ("x = ['a']\n" + "x = x + x\n" * 30 + "setup(data_files=[('share/p', x)])", True),
        ("def f(n):\n    return f(n)\nsetup(data_files=f('a'))", False),
        ("a = 'a'\n" + "a = a + a\n" * 60 + "setup(data_files=[('share/p', [a])])", False),
        ("for a in ['a']:\n" + "".join(" " * n + "for a in [a, a, a, a]:\n" for n in range(1, 15)) + " " * 15 + "b = a\n"
         "setup(data_files=[])", False),
    ],
)  # fmt: skip
def test_what_is_not_understood_is_not_taken_for_all(setup: str, complete: bool) -> None:
    installed = read_setup(setup)
    assert installed is None or installed.is_complete == complete


def test_a_setup_py_without_data_files_or_syntax_says_nothing() -> None:
    assert read_setup("setup(**arguments)") is None
    assert read_setup("setup(data_files=") is None
    assert read_installed_files("p", "", {}.get) is None


def test_the_finder_follows_a_path_to_the_source_and_takes_what_is_there_first(tmp_path: Path) -> None:
    for name in ("description/urdf/a.urdf", "description/urdf/b.urdf", "urdf/b.urdf"):
        (tmp_path / "p" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "p" / name).write_text("")
    (tmp_path / "p/package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "p/CMakeLists.txt").write_text("install(DIRECTORY description/urdf DESTINATION share/p)")
    finder = PackageFinder(tmp_path / "p", environment={})
    assert finder.find_source(tmp_path / "p/urdf/a.urdf") == tmp_path / "p/description/urdf/a.urdf"
    assert finder.find_source(tmp_path / "p/urdf/b.urdf") == tmp_path / "p/urdf/b.urdf"
    assert finder.find_source(tmp_path / "p/urdf/c.urdf") == tmp_path / "p/urdf/c.urdf"
    resource = finder.resolve_resource("package://p/urdf/a.urdf", tmp_path)
    assert (resource.exists, resource.path) == (True, tmp_path / "p/description/urdf/a.urdf")
