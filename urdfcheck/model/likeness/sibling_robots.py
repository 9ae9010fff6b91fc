"""Names that the model lacks, and that another robot of its package, or another variant of the model, may have.

A file beside a model (a controller configuration, a semantic description) often serves several robots of one package, or a
xacro with every choice of its arguments. A name counts as unknown only where no file of the package can make it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.model_file import EXPRESSION
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.system.files import read_regular, walk

_SUFFIXES = frozenset({".urdf", ".xacro"})
# Of a hundred published packages none has more robot files than this; a larger file is one of many expanded models.
_MOST_FILES = 200
_LARGEST = 1_000_000
_NAMED = re.compile(r"""<(joint|link)\s[^<>]*?\bname\s*=\s*(?:"([^"<>]*)"|'([^'<>]*)')""")
_QUOTED = re.compile(r""""([^"<>]*)"|'([^'<>]*)'""")
_PIECE = re.compile(r"[^\W_]+")
# A name with more expressions than this may become anything.
_MOST_EXPRESSIONS = 3
_LONGEST = 200


@dataclass(frozen=True, eq=False)
class PackageNames:
    """The names of links and joints in the files of a model and of its package."""

    model: Model

    def can_package_have(self, kind: str, name: str) -> bool:
        """Whether a ``kind`` (link or joint) of this name is in one of the files.

        Spelled out, or with expressions whose values are words of the files.
        """
        return self._can_files_have(kind, name, self._all_names) or self.can_started_have(kind, name)

    def can_started_have(self, kind: str, name: str) -> bool:
        """Whether the model has the name with other arguments that a launch file or MoveIt's settings pass to it.

        What cannot be expanded with them may have any.
        """
        from urdfcheck.model.use.started_variants import list_started_variants  # only an unknown name asks for it

        variants = (variant.names for variant in list_started_variants(self.model.source))
        return any(names is None or name in names[kind] for names in variants)

    def can_variants_have(self, kind: str, name: str) -> bool:
        """Whether the files of the model can make the name with any arguments."""
        files = self._model_names
        spelled = name in files.literal[kind] or any(p.fullmatch(name) for p in files.patterns[kind])
        return spelled or bool(files.anything[kind]) or self.can_started_have(kind, name)

    def can_others_have(self, kind: str, name: str) -> bool:
        """Whether the files that the model itself does not use can make the name."""
        return self._can_files_have(kind, name, self._other_names)

    def is_spelled_elsewhere(self, kind: str, name: str) -> bool:
        """Whether a file that the model itself does not use has a ``kind`` of exactly this name."""
        return name in self._other_names.literal[kind]

    def find_other_file_with(self, kind: str, names: Iterable[str]) -> Path | None:
        """Return the first of the files that the model itself does not use that has a ``kind`` of each of these names."""
        wanted = set(names)
        found = (path for path, text in self._other_texts.items() if wanted <= _DeclaredNames([text]).literal[kind])
        return next(found, None)

    def is_typed_elsewhere(self, kind: str, text: str) -> bool:
        """Whether a file that the model itself does not use types the name of a ``kind`` so, with the same expressions."""
        return text in self._other_names.typed[kind]

    def _can_files_have(self, kind: str, name: str, files: _DeclaredNames) -> bool:
        if name in files.literal[kind] or len(name) > _LONGEST:
            return True
        for pattern in files.patterns[kind]:
            match = pattern.fullmatch(name)
            if match and all(
                piece in self._quoted_words for filled in match.groups() for piece in _PIECE.findall(filled)
            ):
                return True
        return bool(files.anything[kind])

    @cached_property
    def _all_names(self) -> _DeclaredNames:
        return _DeclaredNames([file.text for file in self.model.source.files.values()] + [*self._other_texts.values()])

    @cached_property
    def _model_names(self) -> _DeclaredNames:
        return _DeclaredNames([file.text for file in self.model.source.files.values()])

    @cached_property
    def _other_names(self) -> _DeclaredNames:
        return _DeclaredNames([*self._other_texts.values()])

    @cached_property
    def _quoted_words(self) -> frozenset[str]:
        """The words of everything in quotes."""
        texts = [file.text for file in self.model.source.files.values()] + [*self._other_texts.values()]
        quoted = (found for text in texts for match in _QUOTED.finditer(text) for found in match.groups("") if found)
        return frozenset(piece for found in quoted for piece in _PIECE.findall(EXPRESSION.sub(" ", found)))

    @cached_property
    def _other_texts(self) -> dict[Path, str]:
        """The texts, by path, of the package's other robots and macros; without a package, of those beside the model."""
        source = self.model.source
        folder = source.path.absolute().parent if source.package is None else source.package.path
        texts: dict[Path, str] = {}
        for here, names, files in walk(folder):
            names[:] = [
                n for n in names if not n.startswith(".") and n not in BUILD_FOLDERS and source.package is not None
            ]
            for path in (Path(here, name) for name in files):
                if (
                    path.suffix.lower() not in _SUFFIXES
                    or format_path(path) in source.files
                    or not source.finder.can_open(path)
                ):
                    continue
                if len(texts) == _MOST_FILES:
                    return texts
                try:
                    texts[path] = read_regular(path, _LARGEST).decode("utf-8", "replace")
                except OSError:
                    continue
        return texts


@fact
def package_names(model: Model) -> PackageNames:
    """Return the names in the files of a model and of its package, each file read once."""
    return PackageNames(model)


class _DeclaredNames:
    """The names in some texts, by kind (link or joint)."""

    def __init__(self, texts: list[str]) -> None:
        self.literal: dict[str, set[str]] = {"joint": set(), "link": set()}
        """Spelled out."""
        self.typed: dict[str, set[str]] = {"joint": set(), "link": set()}
        """As they are typed."""
        self.patterns: dict[str, set[re.Pattern[str]]] = {"joint": set(), "link": set()}
        """With expressions, one group for each."""
        self.anything: dict[str, set[str]] = {"joint": set(), "link": set()}
        """Those that may become any name."""
        for text in texts:
            for match in _NAMED.finditer(text):
                kind, name = match.group(1), match.group(2) or match.group(3) or ""
                self.typed[kind].add(name)
                fixed = EXPRESSION.split(name)
                if len(fixed) == 1:
                    self.literal[kind].add(name)
                elif len(fixed) - 1 > _MOST_EXPRESSIONS or len(name) > _LONGEST or "$" in "".join(fixed):
                    self.anything[kind].add(name)
                else:
                    self.patterns[kind].add(re.compile("(.*)".join(map(re.escape, fixed)), re.DOTALL))
