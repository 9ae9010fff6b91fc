"""The models and launch files below a folder, and which of them use a file.

Standard library only: this runs before anything heavy is loaded.
"""

from __future__ import annotations

import errno
import fnmatch
import glob
import itertools
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import compile_names, find_nearest_name
from urdfcheck.source.include_graph import IncludeGraph, UserTable, iter_bits
from urdfcheck.source.model_file import EXPRESSION, ModelFile, find_file_names, may_compute_name
from urdfcheck.source.package.file_kinds import CONFIG_FOLDERS, is_launch, is_model, is_srdf, is_xacro
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.package_folders import (
    BUILD_FOLDERS,
    IGNORE_MARKS,
    TEST_FOLDERS,
    drop_comments,
    get_used_name,
    is_aside_folder,
    is_old_state,
    iter_package_texts,
    read_manifest_name,
    read_package_texts,
)
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system.git import list_ignored

# Limit on the file names that are compared with the patterns of includes: beyond it a file counts as not included, and is
# checked as a model.
MAX_COMPARED = 500_000
_SKIPPED = BUILD_FOLDERS | {"node_modules", "__pycache__"}
# Folders with the data of tests, by their names in lower case.
_TEST_FOLDERS = TEST_FOLDERS | {"benchmark", "benchmarks", "fixtures", "test_data", "testdata"}
# What the tests of a parser call a robot that it must refuse.
_REFUSED = re.compile(r"(?:fail|invalid|malformed|broken|bad)(?![a-z])")
# The name of a file and that of its folder before it: in a path, or as arguments that make one.
_PLACED_NAME = re.compile(r"""(?<![\w.-])([\w.-]+)["',\s/\\]+([\w.-]+\.[A-Za-z]\w*)""")
# A file that a variable of the environment names, and the one that is included if it is not set.
_OPTIONAL = re.compile(r"^\$\(optenv\s+\S+\s+([^)]*)\)(.*)$", re.DOTALL)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundModel:
    """A file in a folder that is a model, or that only its expansion shows to be one."""

    path: Path
    is_tentative: bool = False
    """Whether it is not a model if it makes neither link nor joint."""
    is_part: bool = False
    """Whether another file includes it, or may: then it is a model only if it is one by itself."""


class FolderIndex:
    """The files below a folder that can matter, read once. ``read``: reads a model file; None where it gave that up."""

    def __init__(self, path: Path, finder: PackageFinder, read: Callable[[Path], ModelFile | None] = ModelFile) -> None:
        self.path = path
        self.finder = finder
        self.outside: list[Path] = []
        self.unreadable: list[tuple[Path, str]] = []
        self.marked: list[Path] = []
        """Folders below that build tools are told to leave out, and with them this check."""
        files = sorted(_iter_files(path, finder, self.outside, self.unreadable, self.marked))
        self.packages = [f.parent for f in files if f.name == "package.xml"]
        finder.note_packages(self.packages)
        self.launches = [f for f in files if is_launch(f)]
        self.files = {f: file for f in files if is_model(f) and (file := read(f)) is not None}
        self.srdfs = {f: file for f in files if is_srdf(f) and (file := read(f)) is not None}
        self.reals = {f: resolve_path(f) for f in (*self.files, *self.srdfs, *self.launches)}
        self.by_real = {self.reals[f]: file for f, file in self.files.items()}
        self.by_name: dict[str, set[Path]] = {}
        for f in self.files:
            self.by_name.setdefault(f.name, set()).add(self.reals[f])
        self.compared = 0
        self.resolved: dict[tuple[str, ...], frozenset[Path]] = {}
        # The folders in which a file without a name may be a part: a file there includes whatever a variable names.
        self.open_folders: set[Path] = set()
        self.mentioned: set[Path] = set()
        includes = {self.reals[f]: self._resolve_includes(f, file.includes) for f, file in self.files.items()}
        for f, file in self.files.items():
            self.mentioned |= self._resolve_includes(f, set(file.mentions).difference(file.includes))
        self.graph = IncludeGraph({path: inner & self.by_real.keys() for path, inner in includes.items()})

    def _resolve_includes(self, path: Path, names: Iterable[str]) -> set[Path]:
        """Return the files that the includes of a file mean."""
        included: set[Path] = set()
        for name in names:
            optional = _OPTIONAL.match(name)
            if optional:
                included |= self._resolve_include(path, "".join(optional.groups()))
            included |= self._resolve_include(path, name)
        return included - {self.reals[path]}

    def _resolve_include(self, path: Path, name: str) -> frozenset[Path]:
        """Return the files that one include means; one with arguments in its path may mean every file of its name."""
        tail = EXPRESSION.sub("", name).lstrip("/")
        package = re.match(r"\$\(find ([^)\s]+)\)", name)
        folders = self.finder.list_meant(package.group(1), path) if package else [path.parent]
        last = Path(tail).name
        if not last:
            around = self.finder.find_package_of(path.absolute())
            self.open_folders.add(resolve_path(path.parent if around is None else around.path))
            return frozenset()
        base = folders[0] if folders else path.parent
        typed_name = name.rpartition("/")[2]
        is_open = EXPRESSION.search(typed_name) is not None
        key = (f"{tail}/{typed_name}" if is_open else tail, *map(str, folders or [base]))
        if key not in self.resolved:
            targets = [target for folder in folders for target in self._match_pattern(folder, tail)]
            if package and not targets:
                targets = [str(self.finder.find_source(folder / tail)) for folder in folders]
            if any(map(os.path.isfile, targets)):
                found = {resolve_path(Path(target)) for target in targets}
            else:
                found = self.by_name.get(last, set()) | (set() if is_open else self._find_misspelt(base, tail))
            if is_open:
                found |= self._match_parts((base / tail).parent, typed_name)
            self.resolved[key] = frozenset(found)
        return self.resolved[key]

    def _find_misspelt(self, folder: Path, tail: str) -> set[Path]:
        """Return the file that a misspelt include means: the slip is reported there, and does not make its file a model."""
        name, beside = Path(tail).name, resolve_path((folder / tail).parent)
        if not name or name in self.by_name:
            return set()
        near = find_nearest_name(name, self._parts_by_folder.get(beside, ()))
        return set() if near is None else {beside / near}

    def _match_parts(self, folder: Path, typed: str) -> set[Path]:
        """Return the files of a folder that an include with an argument in their name may mean.

        What may be a robot by itself is only mentioned: it is checked even if it is included.
        """
        real = resolve_path(folder)
        names, robots = self._parts_by_folder.get(real, ()), self._robots_by_folder.get(real, ())
        self.compared += len(names) + len(robots)
        if self.compared > MAX_COMPARED:
            return set()
        self.mentioned |= {real / name for name in robots if may_compute_name(typed, name)}
        return {real / name for name in fnmatch.filter(names, EXPRESSION.sub("*", typed))}

    @cached_property
    def _parts_by_folder(self) -> dict[Path, list[str]]:
        """The names of the xacro files that are not models by themselves, by their folder."""
        return self._list_by_folder(stand_alone=False)

    @cached_property
    def _robots_by_folder(self) -> dict[Path, list[str]]:
        """The names of the xacro files that may be models by themselves, by their folder."""
        return self._list_by_folder(stand_alone=True)

    def _list_by_folder(self, *, stand_alone: bool) -> dict[Path, list[str]]:
        names: dict[Path, list[str]] = {}
        for real, file in self.by_real.items():
            if is_xacro(real) and file.stands_alone == stand_alone:
                names.setdefault(real.parent, []).append(real.name)
        return names

    def _match_pattern(self, folder: Path, pattern: str) -> list[str]:
        """Return the files that a pattern means; only folders that may be opened are searched."""
        steady = os.path.dirname(re.split(r"[*?[]", pattern, maxsplit=1)[0])
        if not self.finder.can_open(folder / steady) or ".." in Path(pattern[len(steady) :]).parts:
            return []
        places = [str(folder)]
        for part in Path(pattern).parts:
            if glob.has_magic(part):
                places = [os.path.join(place, name) for place in places for name in self._match_names(place, part)]
            else:
                places = [os.path.join(place, part) for place in places]
        return [path for path in places if os.path.lexists(path)]

    def _match_names(self, folder: str, pattern: str) -> list[str]:
        """Return the matching names in a folder; none once circular links have used up the comparisons."""
        if self.compared > MAX_COMPARED or not self.finder.can_open(Path(folder)):
            return []
        try:
            names = [name for name in os.listdir(folder) if pattern.startswith(".") or not name.startswith(".")]
        except (OSError, ValueError):
            names = []
        self.compared += 20 + len(names)
        return fnmatch.filter(names, pattern)

    @cached_property
    def found_models(self) -> tuple[FoundModel, ...]:
        """The models of the folder: not mere parts of others, nor mere sets of macros."""
        found: list[FoundModel] = []
        for path, file in self.files.items():
            if file.only_macros or file.is_foreign:
                continue
            is_part = self._may_be_part(self.reals[path], file)
            if is_part and not file.has_name:
                continue
            # An empty robot is a placeholder that others include; a file without a robot is reported as not a robot.
            is_tentative = not file.has_parts if file.is_xacro else file.is_robot and file.is_empty
            found.append(FoundModel(path=path, is_tentative=is_tentative, is_part=is_part))
        found += [FoundModel(path=path) for path, file in self.srdfs.items() if file.makes_robot]
        return tuple(found)

    @cached_property
    def candidates(self) -> tuple[FoundModel, ...]:
        """The files that are models only if no model turns out to be made of them.

        These are parts without a name, and semantic descriptions in which a macro could make links.
        """
        models = {model.path for model in self.found_models}
        files = [f for f, file in self.files.items() if not (file.only_macros or file.is_foreign or f in models)]
        files += [f for f, file in self.srdfs.items() if f not in models and is_xacro(f) and file.has_parts]
        return tuple(FoundModel(path=path, is_tentative=True, is_part=True) for path in files)

    def is_named(self, path: Path) -> bool:
        """Whether another file of the folder names this one outside comments: a model, a launch file, or a text of a package."""
        name, own = compile_names((path.name,)), {path, path.absolute()}
        if self.graph.is_included(self.reals[path]):
            return True
        models = (file.text for other, file in self.files.items() if other not in own)
        tops = [self.path, *self.packages]
        texts = (text for top in tops for text in read_package_texts(top, self.finder.can_open))
        naming = filter(name.search, itertools.chain(models, texts))
        return any(name.search(drop_comments(text)) for text in naming)

    def is_test_data(self, path: Path) -> bool:
        """Whether a file is in a folder of tests, or is kept and not used, and no file outside such folders includes or names
        it."""
        is_such = self._is_in_tests(path) or self._is_kept_copy(path)
        return self.is_in_unused_package(path) or (is_such and not self._is_named_outside_tests(path))

    def _is_named_outside_tests(self, path: Path) -> bool:
        """Whether a file outside folders of tests names a file, or one of its name: not if that is another in the same package,
        and no file names this one with its folder."""
        if path.name not in self._names_outside_tests:
            return False
        if (path.parent.name, path.name) in self._placed_names_outside_tests:
            return True
        top = self._find_package_folder(path)
        namesakes = (file for file in self._models_by_name[path.name] if not self._is_in_tests(file))
        return not any(self._find_package_folder(file) == top for file in namesakes)

    def _find_package_folder(self, path: Path) -> Path:
        return next((folder for folder in path.parents if folder in self.packages), self.path)

    @cached_property
    def _models_by_name(self) -> Mapping[str, list[Path]]:
        found: dict[str, list[Path]] = {}
        for path in self.files:
            found.setdefault(path.name, []).append(path)
        return found

    def is_in_unused_package(self, path: Path) -> bool:
        """Whether a file is in a package that is kept and not used: it is in a folder for such below this one, and no text of a
        package elsewhere names it. Whatever its own launch files start is not used either."""
        return not self._unused_packages.isdisjoint(path.absolute().parents)

    @cached_property
    def _unused_packages(self) -> frozenset[Path]:
        kept = {p: name for p in self.packages if self._is_aside(p / "package.xml") and (name := read_manifest_name(p))}
        named: set[str] = set()
        if kept:
            words = compile_names(kept.values())
            for top in [top for top in self.packages if top not in kept]:
                for path, text in iter_package_texts(top, self.finder.can_open):
                    if not self._is_aside(path):
                        named.update(words.findall(drop_comments(text)))
        return frozenset(p.absolute() for p, name in kept.items() if name not in named)

    def _is_aside(self, path: Path) -> bool:
        return self._is_in_folder(path, is_aside_folder)

    def is_data_of_test(self, path: Path, launch: Path) -> bool:
        """Whether a file is data of tests that a launch file in a folder of tests starts; both may be outside this folder."""
        here, there = self._find_inside(path), self._find_inside(launch)
        if here is None or there is None:
            return False
        are_in_tests = self._is_in_folder(there, _is_test_folder) and self._is_in_folder(here, _is_test_folder)
        return are_in_tests and self.is_test_data(here)

    def is_started_aside(self, path: Path, launch: Path) -> bool:
        """Whether a file is kept and not used, and so is the launch file that starts it, in such folders of one package; both may
        be outside this folder."""
        here, there = self._find_inside(path), self._find_inside(launch)
        if here is None or there is None:
            return False
        top = self._find_package_folder(here)
        is_aside = top == self._find_package_folder(there) and all(
            any(map(is_aside_folder, file.relative_to(top).parts[:-1])) for file in (here, there)
        )
        return is_aside and self.is_test_data(here)

    def _find_inside(self, path: Path) -> Path | None:
        """Return a file as one below this folder; None where it is outside."""
        own = self.path.absolute()
        return self.path / path.absolute().relative_to(own) if path.absolute().is_relative_to(own) else None

    def is_kept_aside(self, path: Path) -> bool:
        """Whether a file is in a folder of files that are kept and not used below this one, or is an old copy of one beside it.

        Of files in folders of tests, which tests may read, those whose names say that their robot is refused."""
        if self._is_in_folder(path, _is_test_folder):
            return _REFUSED.match(path.name) is not None
        return self._is_kept_copy(path) or self._is_aside(path)

    def _is_kept_copy(self, path: Path) -> bool:
        """Whether a name says that the file is an old copy of a model beside it: ``arm_ori.urdf`` of ``arm.urdf``.

        ``arm_old.urdf`` is an old state, too, where ``arm.urdf`` has another name now.
        """
        used = get_used_name(path.name)
        if not used:
            return False
        return path.with_name(used) in self.files or (path.parent in self._robot_folders and is_old_state(path.name))

    @cached_property
    def _robot_folders(self) -> frozenset[Path]:
        """The folders with a whole robot whose name does not say that it is an old copy."""
        robots = (model.path for model in self.found_models if not model.is_part)
        return frozenset(path.parent for path in robots if not get_used_name(path.name))

    def _is_in_tests(self, path: Path) -> bool:
        return self._is_in_folder(path, _is_test_folder) or self._is_aside(path)

    def _is_in_folder(self, path: Path, is_such: Callable[[str], bool]) -> bool:
        """Whether a file is in a folder with such a name below this one."""
        inside = path.relative_to(self.path).parts[:-1]
        return any(
            is_such(name) and not self._is_package_of_name(self.path.joinpath(*inside[:level], name))
            for level, name in enumerate(inside)
        )

    def _is_package_of_name(self, folder: Path) -> bool:
        """Whether a folder is a package that is called so: that is a project, whatever its name."""
        package = self.finder.find_package_of(folder.absolute() / "_") if folder in self.packages else None
        return package is not None and package.name == folder.name

    @cached_property
    def _names_outside_tests(self) -> frozenset[str]:
        """The names of files that the models and the texts of packages spell out, except for those in folders of tests."""
        names = {mention.rpartition("/")[2] for mention in self._includes_outside_tests}
        return frozenset(names.union(*(find_file_names(text) for text in self._texts_outside_tests)))

    @cached_property
    def _placed_names_outside_tests(self) -> frozenset[tuple[str, str]]:
        """The same names with their folders, where these are spelled out too."""
        texts = (*self._includes_outside_tests, *self._texts_outside_tests)
        return frozenset(itertools.chain.from_iterable(map(_PLACED_NAME.findall, texts)))

    @cached_property
    def _includes_outside_tests(self) -> list[str]:
        return [typed for path, file in self.files.items() if not self._is_in_tests(path) for typed in file.includes]

    @cached_property
    def _texts_outside_tests(self) -> list[str]:
        return [
            drop_comments(text)
            for top in self.packages or [self.path]
            for path, text in iter_package_texts(top, self.finder.can_open)
            if not self._is_in_tests(path)
        ]

    def may_be_part(self, path: Path) -> bool:
        """Whether another file below the folder includes this one, or may."""
        real = resolve_path(path)
        return real in self.by_real and self._may_be_part(real, self.by_real[real])

    def _may_be_part(self, real: Path, file: ModelFile) -> bool:
        if self.graph.is_included(real) or real in self.mentioned:
            return True
        return not self.open_folders.isdisjoint(real.parents) and not file.has_name

    @cached_property
    def _models(self) -> list[Path]:
        """The models through which a file is checked: those that no other file includes."""
        return [m.path for m in self.found_models if not m.is_part or not self.graph.is_included(self.reals[m.path])]

    @cached_property
    def _users(self) -> UserTable:
        return self.graph.make_user_table([self.reals[model] for model in self._models])

    def find_including_models(self, path: Path) -> list[Path]:
        """Return the models that include a file, directly or through others."""
        real = resolve_path(path)
        users = (self._models[index] for index in iter_bits(self._users.find_users([real])))
        return [model for model in users if self.reals[model] != real]

    def find_models_by_robot_name(self, srdf: Path) -> list[Path]:
        """Return the models of the robot that a semantic description names; a name with expressions may be any."""
        file = self.srdfs.get(srdf)
        wanted = (ModelFile(srdf) if file is None else file).robot_name
        if not wanted:
            return []
        if "\0" in wanted:
            return [model for named in self._models_by_robot_name.values() for model in named]
        named = self._models_by_robot_name
        return named.get(wanted, []) + [model for name, models in named.items() if "\0" in name for model in models]

    def find_models_of_srdf(self, path: Path) -> list[Path]:
        """Return the models of a semantic description or of a part of one: those of all that include it, too."""
        found, queue = {path: None}, [path]
        while queue:
            users = self._find_includers(queue.pop().name).difference(found)
            found.update(dict.fromkeys(sorted(users)))
            queue += users
        srdfs = (file for file in found if is_srdf(file))
        return list(dict.fromkeys(model for srdf in srdfs for model in self.find_models_by_robot_name(srdf)))

    def _find_includers(self, name: str) -> set[Path]:
        """Return the semantic descriptions and their macro files that include a file of this name, or may."""
        literal, patterns = self._srdf_includes
        self.compared += len(patterns)
        fitting = () if self.compared > MAX_COMPARED else (p for p in patterns if fnmatch.fnmatchcase(name, p))
        return literal.get(name, set()).union(*(patterns[pattern] for pattern in fitting))

    @cached_property
    def _srdf_includes(self) -> tuple[dict[str, set[Path]], dict[str, set[Path]]]:
        """The files that include others, by the name of these, and by a pattern where it holds an expression."""
        literal: dict[str, set[Path]] = {}
        patterns: dict[str, set[Path]] = {}
        for path, file in {**self.files, **self.srdfs}.items() if self.srdfs else ():
            for include in file.includes:
                name = EXPRESSION.sub("\0", include).rpartition("/")[2]
                named = (patterns, "*".join(map(glob.escape, name.split("\0")))) if "\0" in name else (literal, name)
                named[0].setdefault(named[1], set()).add(path)
        return literal, patterns

    @cached_property
    def _models_by_robot_name(self) -> dict[str, list[Path]]:
        """The models whose robots have a name, which may hold expressions, by that name."""
        models: dict[str, list[Path]] = {}
        for model in self._models:
            name = self.files[model].robot_name if model in self.files else ""
            if name:
                models.setdefault(name, []).append(model)
        return models

    def find_models_of_srdf_beside(self, settings: Path) -> list[Path]:
        """Return the models of the robots that the semantic descriptions beside a configuration file name."""
        folder = settings.parent
        if folder not in self._models_beside:
            inside = (folder / name for name in _list_folder(str(folder))[1])
            srdfs = [srdf for srdf in inside if is_srdf(srdf) and self.finder.can_open(srdf)]
            found = (model for srdf in srdfs for model in self.find_models_by_robot_name(srdf))
            self._models_beside[folder] = list(dict.fromkeys(found))
        return self._models_beside[folder]

    @cached_property
    def _models_beside(self) -> dict[Path, list[Path]]:
        return {}

    def find_models_configured_by(self, settings: Path) -> list[Path]:
        """Return all models, if the folder is a package and the file is in one of its configuration folders."""
        config_folders = {resolve_path(self.path / name) for name in CONFIG_FOLDERS}
        if resolve_path(settings).parent not in config_folders or not (self.path / "package.xml").is_file():
            return []
        return self._models

    def find_launches_loading(self, settings: Path, package: str) -> list[Path]:
        """Return the launch files that contain the name of a configuration file and of its package."""
        named = self._find_naming_files(settings.name) & self._find_files_with(package)
        return [launch for launch in self.launches if launch in named]

    def find_models_using(self, file: Path, package: str) -> list[Path]:
        """Return the models whose own or included text contains the name of a mesh or of a loaded file, and of its package."""
        naming = set(self._find_naming_files(file.name))
        for pattern, files in self._mesh_patterns.items():
            if pattern.match(file.name):
                naming |= files
        users = self._users.find_users(map(self.reals.__getitem__, naming))
        if package:
            users &= self._users.find_users(map(self.reals.__getitem__, self._find_files_with(package)))
        return [self._models[index] for index in iter_bits(users)]

    @cached_property
    def _all_texts(self) -> dict[Path, ModelFile]:
        return {**self.files, **{launch: ModelFile(launch) for launch in self.launches}}

    @cached_property
    def _files_by_name(self) -> dict[str, set[Path]]:
        """The files in whose texts a file name is spelled out, by name."""
        naming: dict[str, set[Path]] = {}
        for path, file in self._all_texts.items():
            for name in file.collect_file_names():
                naming.setdefault(name, set()).add(path)
        return naming

    @cached_property
    def _mesh_patterns(self) -> dict[re.Pattern[str], set[Path]]:
        """The files that name meshes with expressions, by pattern."""
        patterns: dict[re.Pattern[str], set[Path]] = {}
        for path, file in self.files.items():
            for pattern in file.compile_mesh_patterns():
                patterns.setdefault(pattern, set()).add(path)
        return patterns

    def _find_naming_files(self, name: str) -> set[Path]:
        if find_file_names(name) == [name]:
            return self._files_by_name.get(name, set())
        return self._find_files_with(name)  # a name with blanks or brackets in it

    def _find_files_with(self, text: str) -> set[Path]:
        """Return the files whose texts contain another."""
        if text not in self._files_with:
            self._files_with[text] = {path for path, file in self._all_texts.items() if text in file.text}
        return self._files_with[text]

    @cached_property
    def _files_with(self) -> dict[str, set[Path]]:
        return {}


def _is_test_folder(name: str) -> bool:
    return name.lower() in _TEST_FOLDERS


def resolve_path(path: Path) -> Path:
    """Return the real path: the key under which a file counts once, however it is reached."""
    return Path(os.path.realpath(path))


def _iter_files(
    root: Path, finder: PackageFinder, outside: list[Path], unreadable: list[tuple[Path, str]], marked: list[Path]
) -> Iterator[Path]:
    """Yield the files below a folder, through links too.

    Append links to places that may not be opened to ``outside``, to ``unreadable`` with the reason the folders and possible
    models that cannot be read, and what cannot even be told to be a file or a folder, and to ``marked`` the folders that build
    tools are told to leave out.
    """
    ignored = list_ignored(str(root), outside=str(find_project_folder(root)))
    visited: set[str] = set()
    below = [(str(root), os.path.realpath(root))]
    while below:  # not os.walk, which calls itself for each level
        folder, real = below.pop()
        names, files = _list_folder(folder)
        if real in visited:
            continue
        visited.add(real)
        if folder != str(root) and not IGNORE_MARKS.isdisjoint(files):
            marked.append(Path(folder))  # one that is named is checked
            continue
        if os.path.islink(folder) and not finder.can_open(Path(folder)):
            outside.append(Path(folder))
            continue
        if reason := explain_unreadable(folder, os.R_OK | os.X_OK):
            unreadable.append((Path(folder), reason))
            continue
        for name in names:
            place = os.path.join(real, name)
            if not name.startswith(".") and name not in _SKIPPED and place not in ignored:
                inner = os.path.join(folder, name)
                below.append((inner, os.path.realpath(inner) if os.path.islink(inner) else place))
        for name in files:
            path = Path(folder, name)
            if name.startswith(".") or os.path.join(real, name) in ignored:
                continue
            if os.path.islink(path) and not finder.can_open(path):
                outside.append(path)
            elif _may_be_checked(path) and (reason := explain_unreadable(path)):
                unreadable.append((path, reason))
            elif os.path.isfile(path):
                yield path
            elif _may_be_checked(path):  # a pipe, a socket, a link to nothing: what it could hold is not checked
                leads_nowhere = os.path.islink(path) and not os.path.exists(path)
                reason = "is a link that leads nowhere" if leads_nowhere else "is neither a file nor a folder"
                unreadable.append((path, f"cannot be read: it {reason}"))
            elif reason := explain_unreadable(path, os.F_OK):  # not even whether it is a folder can be told
                unreadable.append((path, reason))


def _may_be_checked(path: Path) -> bool:
    """Whether the name of a file is that of a model, a launch file or a manifest."""
    return is_model(path) or is_srdf(path) or is_launch(path) or path.name == "package.xml"


def explain_unreadable(path: str | Path, mode: int = os.R_OK) -> str:
    """Return why the system refuses access to a file or folder; empty if it grants it.

    Empty too for a link that leads nowhere or in a circle. ``mode``: the access, as of :func:`os.access`.
    """
    try:
        os.stat(path)
        return "" if os.access(path, mode) else f"cannot be read: {os.strerror(errno.EACCES)}"
    except OSError as error:
        leads_nowhere = error.errno in {errno.ENOENT, errno.ENOTDIR, errno.ELOOP}
        return "" if leads_nowhere else f"cannot be read: {error.strerror}"


def _list_folder(folder: str) -> tuple[list[str], list[str]]:
    """Return the names of a folder's subfolders, last first, and of everything else in it."""
    try:
        with os.scandir(folder) as entries:
            names = sorted((entry.name for entry in entries), reverse=True)
    except OSError:
        return [], []
    # entry.is_dir() raises for a circular link, os.path.isdir does not.
    folders = {name for name in names if os.path.isdir(os.path.join(folder, name))}
    return [name for name in names if name in folders], [name for name in names if name not in folders]
