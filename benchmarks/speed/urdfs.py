"""Robots as plain URDF files that urdfcheck and the script read alike: xacro expanded, meshes by absolute path.

``python urdfs.py OUT NAME=MODEL…`` and ``python urdfs.py OUT --corpus CORPUS [--every N]`` write ``OUT/NAME.urdf`` each. A
process of its own, so that the one that measures stays small.
"""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.xml import Element
from urdfcheck.system import libraries


def expanded(path: Path, arguments: Mapping[str, str], package_paths: Sequence[Path] = ()) -> str | None:
    """A model as URDF text; None when it does not expand to any link. What is not found keeps the name that it has."""
    source = load_source(path, arguments, PackageFinder(path.absolute(), paths=package_paths))
    if source.root is None or source.root.tag != "robot" or source.root.find_child("link") is None:
        return None
    return '<?xml version="1.0"?>\n' + "".join(_written(source.root, source))


def _written(element: Element, source: Source) -> Iterator[str]:
    values = {name: a.value for name, a in element.attributes.items() if ":" not in name and name != "xmlns"}
    if element.tag == "mesh" and "filename" in values:
        found = source.finder.resolve_resource(values["filename"], source.path.parent)
        if found.exists and found.path is not None:
            values["filename"] = str(found.path.resolve())
    yield f"<{element.tag}{''.join(f' {name}={quoteattr(value)}' for name, value in values.items())}>"
    yield escape(element.text.strip()) or ("\n" if element.children else "")
    for child in element.children:
        if ":" not in child.tag:  # another vocabulary, which a URDF reader passes over
            yield from _written(child, source)
    yield f"</{element.tag}>\n"


def write_corpus(out: Path, corpus: Path, every: int) -> None:
    """Every ``every``-th model of the corpus that expands to some link, under a name of its id."""
    entries = [e for e in json.loads((corpus / "corpus.json").read_text(encoding="utf-8")) if e["expands"]]
    for entry in entries[::every]:
        roots = [corpus / root for root in entry["package_roots"]]
        text = expanded(corpus / entry["entry"], entry["xacro_args"], roots)
        if text is not None:
            (out / f"{re.sub(r'[^A-Za-z0-9]+', '-', entry['id']).strip('-')}.urdf").write_text(text, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("models", nargs="*")
    parser.add_argument("--corpus", type=Path)
    parser.add_argument("--every", type=int, default=1)
    options = parser.parse_args()
    libraries.prefer_own_folders()
    # The folder is a repository of its own: no workspace is looked for around it.
    (options.out / ".git").mkdir()
    if options.corpus is not None:
        write_corpus(options.out, options.corpus, options.every)
    for name, _, path in (text.partition("=") for text in options.models):
        text = expanded(Path(path), {})
        if text is None:
            raise SystemExit(f"{path} does not expand to any link")
        (options.out / f"{name}.urdf").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
