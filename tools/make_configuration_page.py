"""Make docs/configuration-keys.md from the keys of the configuration: ``python tools/make_configuration_page.py``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from urdfcheck.policy.config_keys import CONFIG_KEYS, ConfigKey, KeyKind

PAGE = Path(__file__).parent.parent / "docs" / "configuration-keys.md"

INTRODUCTION = """\
# Configuration keys

Made from the reader of the configuration by `make reports`. [Configure](configure.md) says where the file is and shows all keys
at work. `urdfcheck config PATH` prints what holds for a file, and where each value comes from.
"""

EDITORS = """\
## In an editor

```
urdfcheck config --schema > urdfcheck.schema.json
```

writes the JSON Schema of `urdfcheck.toml`: all keys, the codes, names and tags of the rules, and their options with defaults and
units. An editor then completes, explains and underlines. The schema belongs to a version of urdfcheck: write it again after an
update.

VS Code with *Even Better TOML*, and each editor with the language server of taplo, find it by the first line of `urdfcheck.toml`:

```
#:schema ./urdfcheck.schema.json
```

For all repositories at once, in the settings of VS Code:

```
"evenBetterToml.schema.associations": {
  "urdfcheck\\\\.toml$": "file:///home/you/urdfcheck.schema.json"
}
```

For a repository, in its `.taplo.toml`:

```toml
[[rule]]
include = ["**/urdfcheck.toml"]

[rule.schema]
path = "./urdfcheck.schema.json"
```

In a job, `check-jsonschema --schemafile urdfcheck.schema.json urdfcheck.toml` checks the file alone. `urdfcheck` does so too, at
each run: an unknown key or a wrong value ends it with exit code 2. What depends on files, such as a path that does not exist,
only `urdfcheck` knows.
"""


def render_page() -> str:
    """Return the text of docs/configuration-keys.md."""
    parts = [INTRODUCTION, _render_keys(CONFIG_KEYS)]
    parts += [
        f"## `[[{key.name}]]`\n\n{key.doc[0].upper()}{key.doc[1:]}.\n\n{_render_keys(key.keys)}"
        for key in CONFIG_KEYS
        if key.kind is KeyKind.TABLES
    ]
    return "\n".join([*parts, EDITORS])


def _render_keys(keys: Iterable[ConfigKey]) -> str:
    rows = [f"| {_name_key(key)} | {_describe_value(key)} | {_describe_default(key)} | {key.doc} |" for key in keys]
    return "\n".join(["| key | value | default | meaning |", "|---|---|---|---|", *rows, ""])


def _name_key(key: ConfigKey) -> str:
    return f"[`[[{key.name}]]`](#{key.name})" if key.kind is KeyKind.TABLES else f"`{key.name}`"


def _describe_value(key: ConfigKey) -> str:
    choices = ", ".join(f"`{choice}`" for choice in key.choices)
    return f"{key.kind.value} {choices}".rstrip()


def _describe_default(key: ConfigKey) -> str:
    if key.is_required:
        return "required"
    return "" if key.default is None else f"`{str(key.default).lower()}`"


if __name__ == "__main__":
    PAGE.write_text(render_page(), encoding="utf-8", newline="\n")
