"""The architecture as a test: imports go downwards only, and the command starts without heavy libraries."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import urdfcheck

PACKAGE = Path(urdfcheck.__file__).parent
HEAVY = {
    "mujoco",
    "numpy",
    "scipy",
    "pinocchio",
    "coal",
    "trimesh",
    "yourdfpy",
    "xacro",
    "lxml",
    "collada",
    "rich",
    "yaml",
}

# What each part of the package may import from it; core, __init__, cache and libraries import nothing of it.
ALLOWED = {
    "facts": {"facts"},
    "files": set(),
    "journal": {"errors", "files"},
    "cluster": {"engine", "errors", "worker", ""},
    "dataset": {"assembly", "catalogue", "core", "engine", "errors", "journal", "output", "source", "worker", ""},
    "source": {"source", "core", "errors", "files"},
    "outline": {"model", "source", "core"},
    "scene": {"model", "source", "facts", "core"},
    "srdf": {"model", "source", "core", "files", ""},
    "cache": {"files"},
    "drop": set(),
    "model": {"model", "source", "facts", "core", "cache", "drop", "files"},
    "checks": {"drop", "model", "source", "facts", "core", "files", "outline"},
    "catalogue": {"core"},
    "config": {"baseline", "catalogue", "core", "files", "source", "suppress"},
    "recall": {"cache", "catalogue", "core", "model"},
    "worker": {
        *("cache", "catalogue", "core", "errors", "files", "limits", "model", "outline", "recall", "scene", "source"),
        *("consumers", "drop", "shared", "srdf", "suppress"),
    },
    "shared": {"core", "source"},
    "patch": {"core", "files", "source", "workers"},
    "fixer": {"core", "engine", "patch"},
    "variants": {"core"},
    "consumers": {"core"},
    "suppress": {"catalogue", "core", "source"},
    "baseline": {"catalogue", "core", "files", "source"},
    "assembly": {
        "baseline",
        "consumers",
        "catalogue",
        "core",
        "files",
        "libraries",
        "shared",
        "source",
        "suppress",
        "variants",
        "worker",
        "",
    },
    "sandbox": {"errors"},
    "limits": set(),
    "pytest_plugin": {"output"},
    "engine": {
        *(
            "",
            "assembly",
            "baseline",
            "cache",
            "catalogue",
            "core",
            "errors",
            "files",
            "libraries",
            "limits",
            "outline",
            "sandbox",
            "source",
            "variants",
            "worker",
        ),
        "workers",
    },
    "engines": {
        *(
            "config",
            "consumers",
            "core",
            "engine",
            "engines",
            "errors",
            "files",
            "libraries",
            "limits",
            "model",
            "sandbox",
        ),
        *("source", "worker", "workers"),
    },
    "output": {"consumers", "core", "drop", "facts", "output"},
    "core": {"errors"},
    "errors": set(),
    "libraries": set(),
    "workers": set(),
}


def imports(path: Path) -> set[str]:
    """The parts of urdfcheck that a module imports when it runs (imports for type checkers only do not count)."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    typing_only = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    found: set[str] = set()
    for node in ast.walk(tree):
        if id(node) in typing_only:
            continue
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "urdfcheck":
            parts = (node.module or "").split(".")
            found |= {parts[1]} if len(parts) > 1 else {a.name if a.name != "__version__" else "" for a in node.names}
        elif isinstance(node, ast.Import):
            found |= {a.name.split(".")[1] for a in node.names if a.name.startswith("urdfcheck.")}
    return found


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: p.relative_to(PACKAGE).as_posix())
def test_imports_go_downwards(path: Path) -> None:
    part = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    if part in {"cli", "__main__", "__init__"}:
        return
    assert imports(path) <= ALLOWED[part], f"{part} must not import these"


def loaded_by(code: str) -> set[str]:
    script = f"import sys\n{code}\nprint(' '.join(sys.modules))"
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    return {name.split(".")[0] for name in out.splitlines()[-1].split()}


def test_help_and_rule_load_the_standard_library_only() -> None:
    help_text = "from urdfcheck.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass"
    assert not loaded_by(help_text) & HEAVY
    assert not loaded_by("from urdfcheck.cli import main; main(['rule', 'INR003'])") & HEAVY


def test_the_parent_of_the_workers_loads_nothing_heavy() -> None:
    assert not loaded_by("import urdfcheck.run.pipeline, urdfcheck.run.audit, urdfcheck.policy.config") & HEAVY


_IMPORTS = (
    "from urdfcheck.policy.policy import Policy; from urdfcheck.rules import load_rules; "
    "from urdfcheck.run.audit import audit_unit; from urdfcheck.run.jobs import AuditSettings, Unit\n"
)


def test_the_source_tier_never_loads_meshes_or_dynamics(tmp_path: Path) -> None:
    model = tmp_path / "r.urdf"
    model.write_text('<robot name="r"><link name="base"/></robot>')
    code = (
        f"{_IMPORTS}audit_unit(Unit(kind='model', path={str(model)!r}, id='r'), "
        "AuditSettings(policy=Policy(codes=frozenset(load_rules()), tier='source')))"
    )
    assert not loaded_by(code) & {"trimesh", "pinocchio", "coal", "yourdfpy", "scipy", "collada"}


def test_a_warm_audit_loads_neither_meshes_nor_dynamics(tmp_path: Path) -> None:
    """What was measured once is recalled: nothing reads a mesh, moves a joint or compares shapes again."""
    trimesh = pytest.importorskip("trimesh")
    (tmp_path / "arm.ply").write_bytes(trimesh.creation.box((0.1, 0.1, 0.4)).export(file_type="ply"))
    shape = '<geometry><mesh filename="arm.ply"/></geometry>'
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    body = f"{inertial}<visual>{shape}</visual><collision>{shape}</collision>"
    model = tmp_path / "r.urdf"
    model.write_text(
        f'<robot name="r"><link name="base">{body}</link><link name="arm">{body}</link>'
        '<joint name="j" type="revolute"><origin xyz="0 0 0.5"/><parent link="base"/><child link="arm"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="1"/></joint></robot>'
    )
    code = (
        f"{_IMPORTS}settings = AuditSettings(policy=Policy(codes=frozenset(load_rules())), "
        f"cache={str(tmp_path / 'cache')!r})\n"
        f"assert not audit_unit(Unit(kind='model', path={str(model)!r}, id='r'), settings).failures"
    )
    heavy = {"trimesh", "pinocchio", "coal", "scipy"}
    assert loaded_by(code) & heavy == heavy
    assert not loaded_by(code) & {*heavy, "yourdfpy", "collada"}
