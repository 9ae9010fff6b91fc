"""The page and the check of a new rule, as a start: both fail their tests until they are filled in."""

from __future__ import annotations

import re
from pathlib import Path

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.rules import find_pages_folder, load_families, load_rules
from urdfcheck.version import __version__

# Marks what is still to be written; the test of the pages rejects it.
TO_DO = "TODO"

PAGE = """\
# {code} {name}

```toml
severity = "warning"
confidence = "proof"
status = "preview"
since = "{version}"
needs = ["source"]
tags = ["TODO"]
consumers = "none"

[headlines]
found = "TODO: what is wrong, e.g. {{kind}} {{name!r}} ends with an underscore"

[messages]
found = "TODO: actual against expected, e.g. {{kind}} {{name!r}} ends with an underscore"

[fixes]
found = "TODO: what repairs it"
```

## What it checks

TODO: one sentence.

## Why it matters

TODO: what goes wrong, in which program. Where a program does something else than loading what was typed, delete the key
`consumers` and put a table `[consumers]` after the last plain key, e.g. `mujoco = "refuses to compile"`.

## How to fix

TODO

## Bad

```urdf
<robot name="r">
  <link name="base_"/> <!-- expect: {code} "base_" -->
</robot>
```

## Good

```urdf
<robot name="r">
  <link name="base"/>
</robot>
```

## When to ignore

TODO

## References

TODO
"""

CHECK = '''\
"""{code}: TODO, what the rule reports, in one sentence."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for part in model.named_elements:
        attribute = part.element.attributes.get("name")
        if attribute is not None and "TODO" in attribute.value:
            yield rule.finding("found", at=attribute, kind=part.element.tag, name=part.name)
'''


def write_new_rule(code: str, name: str, repository: Path | None = None) -> tuple[Path, Path]:
    """Write the page and the check of a rule into a checkout, and return their paths.

    :param repository: the root of the checkout; by default the one that this module is in.
    :raises UrdfcheckError: when the code or name is malformed or taken, its family is unknown, or this is not a checkout.
    """
    root = find_pages_folder().parent if repository is None else repository
    pages, checks = root / "rules", root / "urdfcheck" / "checks"
    if not pages.is_dir() or not checks.is_dir():
        raise UrdfcheckError(f"{root} is not a checkout of urdfcheck: rules/ or urdfcheck/checks/ is missing")
    if not re.fullmatch(r"[A-Z]{3}\d{3}", code):
        raise UrdfcheckError(f"{code!r} is not a code: three capital letters and three digits, e.g. NAM008")
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name):
        raise UrdfcheckError(f"{name!r} is not a name: words in lower case with hyphens, e.g. dangling-underscore")
    if code[:3] not in load_families():
        raise UrdfcheckError(f"the family {code[:3]} does not exist: add it to rules/families.toml first")
    for rule in load_rules().values():
        if code == rule.code:
            raise UrdfcheckError(f"the code {code} is taken: {rule.code} {rule.name}")
        if name == rule.name:
            raise UrdfcheckError(f"the name {name} is taken: {rule.code} {rule.name}")
    page = pages / f"{code}-{name}.md"
    module = checks / f"{page.stem.lower().replace('-', '_')}.py"
    for path in (page, module):
        if path.exists():
            raise UrdfcheckError(f"{path} exists already; nothing was written")
    page.write_text(PAGE.format(code=code, name=name, version=__version__), encoding="utf-8", newline="\n")
    module.write_text(CHECK.format(code=code), encoding="utf-8", newline="\n")
    return page, module
