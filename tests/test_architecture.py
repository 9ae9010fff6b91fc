"""The architecture as a test: imports go downwards only, names say what they do, and the command loads nothing heavy."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

import urdfcheck

pytestmark = pytest.mark.slow

PACKAGE = Path(urdfcheck.__file__).parent
LINT_IMPORTS = [
    sys.executable,
    "-c",
    "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()",
]
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

# Beside the rooms: what truly belongs to all of them.
LOOSE = {"__init__", "__main__", "api", "rule_pages", "rules", "version"}
# A folder that holds one module per rule.
CATALOGUE = {"checks"}
# Beginnings of function names; those of booleans too.
VERBS = set((Path(__file__).parent / "verbs.txt").read_text(encoding="utf-8").split())


def test_the_contracts_of_the_imports_hold() -> None:
    """Downwards only, no cycle: pyproject.toml has the contracts, and the message the chain of imports that breaks one."""
    done = subprocess.run([*LINT_IMPORTS, "--no-cache"], cwd=PACKAGE.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_module_lies_loose_at_the_top() -> None:
    assert {path.stem for path in PACKAGE.glob("*.py")} <= LOOSE


def test_no_folder_holds_more_modules_than_one_can_survey() -> None:
    folders = {path.parent for path in PACKAGE.rglob("*.py")} - {PACKAGE / name for name in CATALOGUE}
    size = {str(f.relative_to(PACKAGE)): len([p for p in f.glob("*.py") if p.stem != "__init__"]) for f in folders}
    assert {name: count for name, count in size.items() if count > 14} == {}


@cache
def list_definitions() -> list[ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef]:
    """All functions and classes of the package."""
    return [
        node
        for path in PACKAGE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
    ]


def test_functions_begin_with_a_verb() -> None:
    """At least 60 of 100 begin with a verb, and at most 45 have one word (properties and the checks of the rules included)."""
    names = [
        node.name.strip("_")
        for node in list_definitions()
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and not node.name.startswith("__")
    ]
    one_word = sum("_" not in name for name in names) / len(names)
    verb_first = sum(name.partition("_")[0] in VERBS for name in names) / len(names)
    assert one_word <= 0.45
    assert verb_first >= 0.60


def test_exceptions_end_in_error_and_class_names_mean_one_thing() -> None:
    classes = [
        (node.name, {base.id for base in node.bases if isinstance(base, ast.Name)})
        for node in list_definitions()
        if isinstance(node, ast.ClassDef)
    ]
    count = Counter(name.strip("_") for name, _ in classes)
    assert {name for name, times in count.items() if times > 1} == set()
    raised = {name for name, bases in classes if any(b == "Exception" or b.endswith("Error") for b in bases)}
    assert {name for name in raised if not name.endswith("Error")} == set()


_IMPORTS = (
    "from urdfcheck.policy.policy import Policy; from urdfcheck.rules import load_rules; "
    "from urdfcheck.run.unit_audit import audit_unit; from urdfcheck.run.jobs import AuditSettings, Unit\n"
)


def loaded_by(code: str) -> set[str]:
    script = f"import sys\n{code}\nprint(' '.join(sys.modules))"
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    return {name.split(".")[0] for name in out.splitlines()[-1].split()}


def test_help_and_rule_load_the_standard_library_only() -> None:
    help_text = "from urdfcheck.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass"
    assert not loaded_by(help_text) & HEAVY
    assert not loaded_by("from urdfcheck.cli import main; main(['rule', 'INR003'])") & HEAVY


def test_the_parent_of_the_workers_loads_nothing_heavy() -> None:
    assert not loaded_by("import urdfcheck.run.pipeline, urdfcheck.run.unit_audit, urdfcheck.policy.config") & HEAVY


def test_the_source_tier_never_loads_meshes_or_dynamics(tmp_path: Path) -> None:
    model = tmp_path / "r.urdf"
    model.write_text('<robot name="r"><link name="base"/></robot>')
    code = (
        f"{_IMPORTS}audit_unit(Unit(kind='model', path={str(model)!r}, id='r'), "
        "AuditSettings(policy=Policy(codes=frozenset(load_rules()), tier='source')))"
    )
    assert not loaded_by(code) & {"trimesh", "pinocchio", "coal", "yourdfpy", "scipy", "collada"}


def test_the_text_of_a_sound_robot_is_checked_without_arrays(tmp_path: Path) -> None:
    """numpy takes as long to load as all else together."""
    inertial = (
        '<inertial><origin xyz="0 0 0.1"/><mass value="1.2"/>'
        '<inertia ixx="0.01" ixy="0" ixz="1e-4" iyy="0.01" iyz="0" izz="0.004"/></inertial>'
    )
    rod, drawn = (
        '<geometry><cylinder radius="0.04" length="0.2"/></geometry>',
        '<geometry><mesh filename="arm.stl"/></geometry>',
    )
    for shape in (rod, drawn):
        origin = '<origin xyz="0 0 0.1" rpy="0 0 1.57"/>'
        links = "".join(
            f'<link name="{name}">{inertial}<visual>{origin}{shape}</visual><collision>{origin}{shape}</collision></link>'
            for name in ("base", *(f"{side}_{part}" for side in ("left", "right") for part in ("arm", "wrist", "hand")))
        )
        joints = "".join(
            f'<joint name="{side}_joint_{child}" type="revolute"><origin xyz="0 {y} 0.2"/><parent link="{parent}"/>'
            f'<child link="{side}_{child}"/><axis xyz="0 1 0"/>'
            '<limit lower="-1.2" upper="1.3" effort="40" velocity="2"/></joint>'
            for side, across in (("left", 0.05), ("right", -0.05))
            for parent, child, y in (
                ("base", "arm", across),
                (f"{side}_arm", "wrist", 0),
                (f"{side}_wrist", "hand", 0),
            )
        )
        model = tmp_path / "r.urdf"
        model.write_text(f'<robot name="r">{links}{joints}</robot>')
        code = (
            "from urdfcheck.run.preload import preload_modules\npreload_modules('source')\n"
            f"{_IMPORTS}audit_unit(Unit(kind='model', path={str(model)!r}, id='r'), "
            "AuditSettings(policy=Policy(codes=frozenset(load_rules()), tier='source')))"
        )
        assert "numpy" not in loaded_by(code)


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
    heavy = {"pinocchio", "coal", "scipy"}
    assert loaded_by(code) & heavy == heavy
    assert not loaded_by(code) & {*heavy, "trimesh", "yourdfpy", "collada"}
