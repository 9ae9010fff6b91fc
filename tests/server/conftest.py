"""What the tests of the language server share; without the libraries that it takes there are none."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from .editor import Editor

collect_ignore_glob = [] if all(map(importlib.util.find_spec, ("pygls", "pytest_lsp"))) else ["test_*.py"]


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    """One server for the tests of a module, for what takes no meshes."""
    from .editor import Editor

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        editor = Editor(tmp_path_factory.mktemp("workspace"), "--tier", "source")
        yield editor
        editor.end()


@pytest.fixture
def project(editor: Editor, request: pytest.FixtureRequest) -> Iterator[Path]:
    """A package of its own in the editor's folder; at the end nothing is open."""
    folder = editor.folder / f"{request.node.originalname}-{len(list(editor.folder.iterdir()))}"
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").write_text("<package format='3'><name>robot</name></package>")
    yield folder
    editor.close_all()
