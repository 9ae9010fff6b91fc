"""yaml files by their path, as far as they may be opened."""

from __future__ import annotations

import os
from pathlib import Path

from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.xml import SourceFile, XmlError
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue


def read_located_yaml(path: Path, finder: PackageFinder) -> YamlValue | None:
    """Return the content of a file; None if it is empty, cannot be read or may not be opened.

    :raises YamlReadError: as :func:`~urdfcheck.source.text.yaml.reader.parse_located_yaml`, and if its bytes are not text.
    """
    source = read_yaml_text(path, finder)
    if source is None:
        return None
    # PyYAML takes a start 12 ms, and most robots have none.
    from urdfcheck.source.text.yaml.reader import parse_located_yaml

    return parse_located_yaml(source)


def read_yaml_text(path: Path, finder: PackageFinder) -> SourceFile | None:
    """Return the text of a file; None if it cannot be read or may not be opened.

    :raises YamlReadError: if its bytes are not text, or too many.
    """
    if not finder.can_open(path) or not os.path.isfile(path):
        return None
    try:
        return SourceFile.read(path, format_path(path), declares=False)
    except OSError:
        return None
    except XmlError as error:  # its encoding or size
        raise YamlReadError(str(error), error.span) from error


def find_yaml_error(path: Path, finder: PackageFinder) -> YamlReadError | None:
    """Return why a file is not yaml; None if it is, or may not be opened."""
    try:
        read_located_yaml(path, finder)
    except YamlReadError as error:
        return error
    return None
