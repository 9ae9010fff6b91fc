"""The container image and the conda recipe: they hold what the wheel needs, and say what pyproject.toml says."""

from __future__ import annotations

import re
import shlex
from typing import Any

import pytest
import tomli
import yaml
from conftest import REPOSITORY

from urdfcheck.version import __version__

CONTAINER = REPOSITORY / "packaging/container"
DOCKERFILE = (CONTAINER / "Dockerfile").read_text(encoding="utf-8")
PROJECT = tomli.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
RECIPE = yaml.safe_load((REPOSITORY / "packaging/conda/recipe.yaml").read_text(encoding="utf-8"))
# What conda calls what pip calls otherwise; None: it comes with another package.
CONDA_NAMES = {"pin": "pinocchio", "cmeel-urdfdom": None, "cmeel-tinyxml2": None}


def read_instructions(name: str) -> list[str]:
    lines = re.sub(r"\\\n", " ", DOCKERFILE).splitlines()
    return [line.split(maxsplit=1)[1] for line in lines if line.startswith(f"{name} ")]


def test_the_image_is_pinned_and_runs_as_nobody_special() -> None:
    first, *others = read_instructions("FROM")
    assert re.fullmatch(r"docker\.io/library/python:3\.\d+-slim@sha256:[0-9a-f]{64} AS base", first)
    assert others == ["base AS build", "base"]
    last = DOCKERFILE.rpartition("\nFROM ")[2]
    assert re.findall(r"^USER (.*)$", last, re.MULTILINE) == ["65532:65532"]
    assert shlex.split(read_instructions("ENTRYPOINT")[0]) == ["[urdfcheck]"]


def test_the_image_is_built_from_what_the_wheel_is_built_from() -> None:
    copied = {place for words in read_instructions("COPY")[:-1] for place in words.split()[:-1]}
    wheel = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    needed = {*wheel["packages"], *wheel["force-include"], "pyproject.toml"}
    needed |= {PROJECT["project"]["readme"], *PROJECT["project"]["license-files"]}
    assert copied == needed
    assert all((REPOSITORY / place).exists() for place in copied)
    lines = (CONTAINER / "Dockerfile.dockerignore").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "*"
    assert {line.removeprefix("!") for line in lines if line.startswith("!")} == needed


def split_requirement(text: str, pattern: str) -> tuple[str, frozenset[str]]:
    match = re.match(pattern, text)
    assert match is not None, text
    return match[1].lower(), frozenset(filter(None, match[2].split(",")))


def test_the_recipe_needs_what_the_wheel_needs() -> None:
    asked: list[Any] = [split_requirement(text, r"([\w-]+)([^;]*)") for text in PROJECT["project"]["dependencies"]]
    renamed = {CONDA_NAMES.get(name, name): bounds for name, bounds in asked}
    renamed.pop(None)
    found = dict(split_requirement(text, r"([\w-]+) (.*)") for text in RECIPE["requirements"]["run"])
    assert found.pop("python") == {PROJECT["project"]["requires-python"]}
    assert found == renamed
    assert RECIPE["context"]["version"] == __version__
    (script,) = RECIPE["build"]["python"]["entry_points"]
    assert script == f"urdfcheck = {PROJECT['project']['scripts']['urdfcheck']}"
    assert RECIPE["about"]["summary"] == PROJECT["project"]["description"]


def test_rattler_build_reads_the_recipe() -> None:
    rattler = pytest.importorskip("rattler_build", reason="RATTLER-BUILD IS NOT INSTALLED: it does not read the recipe")
    (variant,) = rattler.Stage0Recipe.from_file(REPOSITORY / "packaging/conda/recipe.yaml").render()
    assert "urdfcheck" in repr(variant)
