"""Which glTF meshes keep their geometry in a file."""

from __future__ import annotations

import os
import re
from pathlib import Path
from urllib.parse import unquote

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.files import read_regular

# Bytes of a document, which is small where its geometry lies in another file, and documents that are looked at.
_LARGEST_DOCUMENT = 16_000_000
_MOST_DOCUMENTS = 1_000
_URI = re.compile(rb'"uri"\s*:\s*"([^"\\]{1,4000})"')


def find_buffer_users(buffer: Path, top: Path, finder: PackageFinder) -> list[Path]:
    """Return the documents beside a file, and in the folders around it up to ``top``, that name it."""
    real = os.path.realpath(buffer)
    folders = [folder for folder in buffer.absolute().parents if folder == top or folder.is_relative_to(top)]
    documents = [document for folder in folders for document in _list_documents(folder, finder)]
    return [document for document in documents[:_MOST_DOCUMENTS] if real in _list_buffers(document)]


def _list_documents(folder: Path, finder: PackageFinder) -> list[Path]:
    """Return the glTF documents of a folder that may be opened."""
    try:
        names = sorted(name for name in os.listdir(folder) if name.lower().endswith(".gltf"))
    except OSError:
        return []
    return [folder / name for name in names if finder.can_open(folder / name)]


def _list_buffers(document: Path) -> set[str]:
    """Return the real paths of the files that a document names."""
    try:
        text = read_regular(document, _LARGEST_DOCUMENT)
    except OSError:
        return set()
    names = (unquote(uri.decode("utf-8", "replace")) for uri in _URI.findall(text))
    return {os.path.realpath(document.parent / name) for name in names if "\0" not in name}
