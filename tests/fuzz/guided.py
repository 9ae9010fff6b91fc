"""Inputs that coverage leads to (atheris, libFuzzer): bytes straight into one reader, without the engine around it."""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from fuzz import meshes, seeds
from fuzz.expressions import BOMBS, HOSTILE, Language

# Longer than the deadlines of the readers, shorter than patience.
_SLOW, _SPACE = 10, 3_000


def main() -> int:
    """``python -m tests.fuzz --atheris FORMAT``: libFuzzer on the reader of a format; what it finds is written to a folder."""
    p = argparse.ArgumentParser(
        prog="python -m tests.fuzz", description="Inputs that coverage leads to (needs atheris)."
    )
    p.add_argument("--atheris", metavar="FORMAT", help="expression, xml or a mesh format")
    p.add_argument("--seconds", type=int, default=300, help="how long (default: 300)")
    p.add_argument(
        "--out", type=Path, default=Path(tempfile.gettempdir()) / "urdfcheck-fuzz", help="where failing inputs go"
    )
    options = p.parse_args()
    import atheris  # only here: the tests do without

    name = options.atheris
    with atheris.instrument_imports(include=["urdfcheck", "xacro", "collada", "trimesh"], enable_loader_override=False):
        target, corpus = _TARGETS.get(name, _mesh)(name)
        for data in corpus:  # what is imported at the first use is instrumented too
            target(data)
    folder = Path(tempfile.mkdtemp(prefix=f"urdfcheck-atheris-{name}-"))
    for index, data in enumerate(corpus):
        (folder / str(index)).write_bytes(data)
    options.out.mkdir(parents=True, exist_ok=True)
    limits = [f"-max_total_time={options.seconds}", f"-timeout={_SLOW}", f"-rss_limit_mb={_SPACE}", "-max_len=8192"]
    told = [f"-artifact_prefix={options.out}/{name}-", "-len_control=0", "-print_final_stats=1", str(folder)]
    atheris.Setup([sys.argv[0], *limits, *told], target)
    atheris.Fuzz()
    return 0


Target = tuple[Callable[[bytes], None], list[bytes]]


def _mesh(name: str) -> Target:
    from urdfcheck.facts.mesh.decode_limits import MeshError
    from urdfcheck.facts.mesh.measure import measure_mesh

    def target(data: bytes) -> None:
        try:
            facts = measure_mesh(data, name)
        except MeshError:
            return
        assert facts.n_triangles > 0
        assert len(facts.components) > 0
        assert facts.faces.max(initial=-1) < len(facts.vertices)

    return target, list(meshes.SOUND[name])


def _xml(_name: str) -> Target:
    from urdfcheck.source.text.xml import SourceFile, XmlError, parse_xml

    with tempfile.NamedTemporaryFile(delete=False) as file:
        path = Path(file.name)

    def target(data: bytes) -> None:
        path.write_bytes(data)
        try:
            source = SourceFile.read(path, "a.urdf")
            root = parse_xml(source)
        except XmlError:
            return
        for element in root.walk():
            assert element.span is not None
            assert source.text[element.span.start : element.span.end].startswith("<")
            for attribute in element.attributes.values():
                if attribute.span is not None:
                    assert source.text[attribute.span.start : attribute.span.end] == attribute.typed

    return target, [text.encode() for text in (seeds.ARM, seeds.XACRO, seeds.LAUNCH_1)]


def _expression(_name: str) -> Target:
    import urdfcheck.source.xacro.expand  # noqa: F401 - else imported too late to be instrumented
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder
    from urdfcheck.source.text.xml import quote_attribute

    folder = Path(tempfile.mkdtemp(prefix="urdfcheck-atheris-"))
    path = folder / "a.urdf.xacro"
    (folder / "values.yaml").write_text(seeds.YAML, encoding="utf-8")
    finder = PackageFinder(path)

    def target(data: bytes) -> None:
        value = quote_attribute(f"${{{data.decode('utf-8', 'replace')}}}")
        path.write_text(
            f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="size" value="3"/>'
            f'<xacro:property name="data" value="${{load_yaml(\'values.yaml\')}}"/><link name={value}/></robot>',
            encoding="utf-8",
        )
        source = load_source(path, {}, finder)
        assert source.root is not None or source.problems

    rng = random.Random(0)
    drawn = [Language().expression(rng) for _ in range(200)]
    return target, [text.encode("utf-8", "replace") for text in (*HOSTILE, *BOMBS, *drawn)]


_TARGETS: dict[str, Callable[[str], Target]] = {"xml": _xml, "expression": _expression}
