"""The recipes of docs/editors.md, in the editors that are installed: a finding arrives."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY

pytestmark = [pytest.mark.slow, pytest.mark.long]

PAGE = (REPOSITORY / "docs" / "editors.md").read_text(encoding="utf-8")
ROBOT = '<robot name="r">\n  <link name="base"/>\n  <link name="base"/>\n</robot>\n'
FOUND = "duplicate link name: base"
# Emacs without a window does not start what waits for the first key, and asks for diagnostics only when told.
WAIT_IN_EMACS = """
(find-file "r.urdf")
(unless (eglot-current-server) (apply #'eglot (eglot--guess-contact)))
(let ((end (+ (float-time) 60)))
  (while (and (< (float-time) end) (not (flymake-diagnostics)))
    (flymake-start)
    (accept-process-output nil 0.2)))
(dolist (found (flymake-diagnostics))
  (princ (format "%d: %s\\n" (line-number-at-pos (flymake-diagnostic-beg found)) (flymake-diagnostic-text found))))
"""
WAIT_IN_NEOVIM = """
vim.wait(60000, function() return #vim.diagnostic.get(0) > 0 end, 100)
for _, found in ipairs(vim.diagnostic.get(0)) do print(string.format("%d: %s\\n", found.lnum + 1, found.message)) end
"""


def read_recipe(editor: str) -> str:
    """The first block of an editor's section."""
    block = re.search(rf"^## {editor}\b.*?^```\w+\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert block is not None
    return block[1]


def run_editor(folder: Path, *command: str) -> str:
    pytest.importorskip("pygls")
    (folder / "r.urdf").write_text(ROBOT)
    (folder / "package.xml").write_text("<package format='3'><name>robot</name></package>")
    subprocess.run(["git", "init", "--quiet"], cwd=folder, check=True)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    own = {"PATH": path, "HOME": str(folder), "XDG_CONFIG_HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **own}, capture_output=True, text=True, timeout=120, check=False
    )
    return done.stdout + done.stderr


def test_emacs_shows_findings(tmp_path: Path) -> None:
    emacs = shutil.which("emacs")
    if emacs is None:
        pytest.skip("there is no Emacs")
    has_eglot = ["--batch", "--eval", "(progn (package-initialize) (require 'eglot))"]
    if subprocess.run([emacs, *has_eglot], capture_output=True).returncode:
        pytest.skip("Emacs has no Eglot")
    script = f"(package-initialize)\n(require 'eglot)\n(require 'flymake)\n{read_recipe('Emacs')}{WAIT_IN_EMACS}"
    (tmp_path / "try.el").write_text(script)
    said = run_editor(tmp_path, emacs, "--batch", "-l", "try.el")
    assert re.search(rf"^3: .*{FOUND}", said, re.MULTILINE), said


def test_neovim_shows_findings(tmp_path: Path) -> None:
    neovim = shutil.which("nvim")
    if neovim is None:
        pytest.skip("there is no Neovim")
    version = re.search(r"v(\d+)\.(\d+)", subprocess.run([neovim, "--version"], capture_output=True, text=True).stdout)
    assert version is not None
    if (int(version[1]), int(version[2])) < (0, 11):
        pytest.skip("Neovim is older than 0.11")
    (tmp_path / "init.lua").write_text(read_recipe("Neovim"))
    (tmp_path / "wait.lua").write_text(WAIT_IN_NEOVIM)
    said = run_editor(tmp_path, neovim, "--headless", "-u", "init.lua", "r.urdf", "-c", "luafile wait.lua", "-c", "qa!")
    assert re.search(rf"^3: .*{FOUND}", said, re.MULTILINE), said
