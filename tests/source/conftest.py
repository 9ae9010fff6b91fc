"""Small xacro files, expanded by us and by plain xacro."""

from __future__ import annotations

import io
import sys
import types
from collections.abc import Callable, Mapping
from contextlib import redirect_stderr
from dataclasses import dataclass
from pathlib import Path

import pytest

from urdfcheck.core import Span
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.xacro.expand import Expansion, expand_xacro


@dataclass(frozen=True)
class Expanded:
    """An expansion, told in the words that were typed: spans are shown as the text at which they point."""

    expansion: Expansion

    @property
    def root(self) -> Element:
        assert self.expansion.root is not None, self.expansion.problems
        return self.expansion.root

    @property
    def problem(self) -> Problem:
        """The one problem that ended the expansion."""
        assert self.expansion.root is None
        (problem,) = [p for p in self.expansion.problems if p.kind != "xacro-warning"]
        return problem

    def named(self, name: str) -> Element:
        """The element of the expanded model with this name."""
        (element,) = [e for e in self.root.walk() if e.get("name") == name]
        return element

    def text(self, span: Span | None) -> str:
        assert span is not None
        return self.expansion.files[span.file].text[span.start : span.end]

    def place(self, span: Span | None) -> str:
        """``file:line text``."""
        assert span is not None
        return f"{span.file}:{span.line} {self.text(span)}"

    def calls(self, element: Element) -> list[str]:
        """The calls and includes that brought an element here, outermost first."""
        return [self.text(span) for span in element.via]

    def origins(self, attribute: Attribute) -> dict[str, str]:
        """The properties, arguments, parameters and keys that a value was computed from, with what was typed there."""
        found: dict[str, str] = {}
        for definition in attribute.collect_definitions():
            span = definition.span
            assert span is not None
            text = Path(span.file).read_text()[span.start : span.end]
            found[f"{definition.kind}[{definition.name}]"] = text
        return found


Expand = Callable[..., Expanded]
LikePlain = Callable[[Expansion, Path, Mapping[str, str], PackageFinder], None]


@pytest.fixture
def assert_like_plain(monkeypatch: pytest.MonkeyPatch) -> LikePlain:
    """Compare an expansion to the byte with plain xacro's, which needs one function of ROS: the one that finds packages."""
    import xacro

    packages = types.ModuleType("ament_index_python.packages")
    monkeypatch.setitem(sys.modules, "ament_index_python", types.ModuleType("ament_index_python"))
    monkeypatch.setitem(sys.modules, "ament_index_python.packages", packages)

    def compare(expansion: Expansion, path: Path, arguments: Mapping[str, str], finder: PackageFinder) -> None:
        packages.get_package_share_directory = lambda name: str(finder.find(name) or 1 / 0)  # type: ignore[attr-defined]
        xacro.substitution_args_context.clear()
        with redirect_stderr(io.StringIO()):
            try:
                plain = xacro.process_file(str(path), mappings=dict(arguments)).toprettyxml(indent="  ")
            except Exception:
                plain = None
        ours = None if expansion.document is None else expansion.document.toprettyxml(indent="  ")
        assert ours == plain, path

    return compare


@pytest.fixture
def expand_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, assert_like_plain: LikePlain) -> Expand:
    """Expand the body of a robot, with other files beside it.

    The result must be that of plain xacro, a failure included, unless ``like_plain=False`` says that we differ on purpose.
    """
    monkeypatch.chdir(tmp_path)

    def run(
        body: str,
        files: Mapping[str, str] | None = None,
        arguments: Mapping[str, str] | None = None,
        *,
        like_plain: bool = True,
    ) -> Expanded:
        main = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>'
        for name, text in {**(files or {}), "robot.xacro": main}.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        finder = PackageFinder(tmp_path, environment={})
        expansion = expand_xacro(tmp_path / "robot.xacro", arguments or {}, finder)
        if like_plain:
            assert_like_plain(expansion, tmp_path / "robot.xacro", arguments or {}, finder)
        return Expanded(expansion)

    return run
