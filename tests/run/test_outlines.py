"""While one types, models are searched again only where the edit may lead to others."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from conftest import make_request

from urdfcheck.run import pipeline
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, run_audit

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
USER = f'{HEAD}<xacro:include filename="part.xacro"/><xacro:body name="base"/></robot>'
PART = f"""{HEAD.replace(' name="r"', "")}<xacro:macro name="body" params="name"><link name="${{name}}"/></xacro:macro></robot>"""


def type_text(request: Request, path: Path, text: str) -> Request:
    """The request as it is after a text was typed."""
    texts = {**request.options.texts, str(path.resolve()): text.encode()}
    return replace(request, options=replace(request.options, texts=texts))


@pytest.mark.parametrize(
    ("name", "text", "searches"),
    [
        ("part.xacro", PART.replace('"${name}"', '"${name}_link"'), 0),
        ("part.xacro", PART.replace("</robot>", '<link name="own"/></robot>'), 1),
        ("part.xacro", PART.replace("</robot>", ""), 1),
        ("user.xacro", USER.replace("base", "body"), 0),
        ("user.xacro", USER.replace("part.xacro", "parts.xacro"), 1),
        ("user.xacro", USER.replace(' name="r"', ""), 1),
        ("package.xml", "<package><name>q</name></package>", 1),
    ],
)
def test_models_are_searched_again_where_an_edit_may_lead_to_others(
    name: str, text: str, searches: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "part.xacro").write_text(PART)
    (tmp_path / "user.xacro").write_text(USER)
    request = make_request(tmp_path / "part.xacro", tmp_path / "user.xacro")
    for path, typed in (("part.xacro", PART), ("user.xacro", USER), ("package.xml", "<package/>")):
        request = type_text(request, tmp_path / path, typed)
    before = run_audit(request, IN_THIS_PROCESS)
    found: list[object] = []
    search = pipeline.discover_targets
    monkeypatch.setattr(pipeline, "discover_targets", lambda **words: found.append(1) or search(**words))
    request = type_text(request, tmp_path / name, text)
    after = run_audit(request, IN_THIS_PROCESS, previous=before, only_texts_differ=True)
    assert len(found) == searches
    anew = run_audit(request, IN_THIS_PROCESS)
    assert (after.plan, after.outcome.findings) == (anew.plan, anew.outcome.findings)


def test_files_that_may_have_changed_are_searched_again(tmp_path: Path) -> None:
    (tmp_path / "part.xacro").write_text(PART)
    request = type_text(make_request(tmp_path / "part.xacro"), tmp_path / "part.xacro", PART)
    before = run_audit(request, IN_THIS_PROCESS)
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "user.xacro").write_text(USER)
    assert not before.plan.models
    assert run_audit(request, IN_THIS_PROCESS, previous=before).plan.models


def test_packages_are_searched_again_where_files_may_have_changed(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    folder = tmp_path / "car"
    folder.mkdir()
    (folder / "package.xml").write_text("<package><name>car</name></package>")
    path = folder / "car.xacro"
    path.write_text(text := USER.replace('"part.xacro"', '"$(find arm)/part.xacro"'))
    run, audited, models = type_text(make_request(path), path, text), None, []
    for number, differ in enumerate((True, True, True, False, True)):
        if number == 2:  # nothing tells that it has come
            (tmp_path / "other").mkdir()
            (tmp_path / "other/package.xml").write_text("<package><name>arm</name></package>")
            (tmp_path / "other/part.xacro").write_text(PART)
        run = type_text(run, path, text.replace('"base"', f'"base_{number}"'))
        audited = run_audit(run, IN_THIS_PROCESS, previous=audited, only_texts_differ=differ)
        models.append(audited.outcome.models[0].links)
    assert models == [0, 0, 0, 1, 1]
