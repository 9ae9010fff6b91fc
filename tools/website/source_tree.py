"""Everything that the generator of the site reads: pages as Markdown, files, and its configuration with the navigation."""

from __future__ import annotations

import json
import shutil
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from urdfcheck.cli.config_schema import render_config_schema
from urdfcheck.rules import find_pages_folder, load_families, load_rules
from website import reference_pages, rule_index, rule_pages, start_page
from website.markdown import convert_markdown
from website.navigation import (
    DEMOS,
    EXIT_CODES,
    NAVIGATION,
    PYTHON_API,
    REPOSITORY,
    RULES_INDEX,
    SAMPLE,
    SCHEMAS,
    START,
    Page,
    Section,
    iter_pages,
    list_archives,
    list_copied_files,
    list_packed_files,
)
from website.rule_pictures import draw_rule

# Pages that functions make, and the file of the repository whose links they have.
_MADE: dict[str, tuple[Callable[[], str], str]] = {
    START.address: (start_page.render_start, "README.md"),
    SAMPLE.address: (start_page.render_sample, "README.md"),
    DEMOS.address: (start_page.render_demos, DEMOS.source),
    EXIT_CODES.address: (reference_pages.render_exit_codes, reference_pages.GATE),
    PYTHON_API.address: (reference_pages.render_python_api, "docs/python.md"),
}
# Their links are those of the site already.
_FINISHED: dict[str, Callable[[], str]] = {
    RULES_INDEX.address: rule_index.render_index,
    SCHEMAS.address: reference_pages.render_schemas,
}
# Who searches for a word looks for a guide or a rule, and seldom for pages about the project itself.
_RANKED_LAST = "---\nsearch:\n  boost: 0.3\n---\n\n"


def write_source_tree(folder: Path) -> Path:
    """Write all that the site is made of into a new folder; return the configuration of the generator."""
    pages = folder / "pages"
    pictured = _write_pictures(pages)
    for address, text in render_pages(pictured).items():
        _write(pages / address, text)
    for path, address in list_copied_files().items():
        _copy(REPOSITORY / path, pages / address)
    for path, address in list_archives().items():
        _pack(path, pages / address)
    for name in ("logo.svg", "regions.js", "rules.js", "site.css"):
        _copy(start_page.ASSETS / name, pages / "assets" / name)
    _copy(start_page.ASSETS / "theme/main.html", folder / "theme/main.html")
    start_page.write_report(_make_room(pages / start_page.REPORT))
    start_page.write_demo_reports(pages)
    start_page.write_recordings(pages / "assets")
    start_page.write_pictures(pages)
    _write(pages / reference_pages.CONFIG_SCHEMA, json.dumps(render_config_schema(), indent=1) + "\n")
    navigation = yaml.safe_dump(
        {"nav": [_list_entry(entry) for entry in NAVIGATION]}, allow_unicode=True, sort_keys=False
    )
    return _write(folder / "mkdocs.yml", (start_page.ASSETS / "mkdocs.yml").read_text(encoding="utf-8") + navigation)


def _write_pictures(pages: Path) -> dict[str, str]:
    """Write the pictures of examples; return what is reported about the bad one, by the code of the rule."""
    pictured = {}
    for code, rule in load_rules().items():
        if pictures := draw_rule(rule):
            pictured[code] = pictures.headline
            for address, content in zip(rule_pages.place_pictures(rule), (pictures.bad, pictures.good), strict=True):
                _make_room(pages / address).write_bytes(content)
    return pictured


def render_pages(pictured: Mapping[str, str]) -> dict[str, str]:
    """Return the Markdown of all pages by their addresses.

    :param pictured: of each rule whose page shows pictures what is reported about the bad example, by its code.
    """
    addresses = list_addresses()
    codes = {code: rule_pages.place_rule(rule) for code, rule in load_rules().items()}

    def convert(text: str, source: str, address: str) -> str:
        return convert_markdown(text, source=source, address=address, addresses=addresses, rules=codes)

    rendered = {}
    for page in iter_pages():
        if page.address in _FINISHED:
            rendered[page.address] = _FINISHED[page.address]()
        elif page.address in _MADE:
            render, source = _MADE[page.address]
            rendered[page.address] = convert(render(), source, page.address)
        else:
            text = (REPOSITORY / page.source).read_text(encoding="utf-8")
            rendered[page.address] = _RANKED_LAST * page.address.startswith("project/") + convert(
                text, page.source, page.address
            )
    for code, rule in load_rules().items():
        rendered[codes[code]] = convert(
            rule_pages.render_rule(rule, pictured.get(code, "")), _name_source(code), codes[code]
        )
    return rendered


def list_addresses() -> dict[str, str]:
    """Return the addresses of pages and files on the site, by the files of the repository that they are made from."""
    pages = {page.source: page.address for page in iter_pages() if page.source}
    rules = {_name_source(code): rule_pages.place_rule(rule) for code, rule in load_rules().items()}
    samples = {"reports": SAMPLE.address, "reports/car-3.html": start_page.REPORT, "README.md": START.address}
    return {**list_copied_files(), **list_archives(), **pages, **rules, **samples}


def _name_source(code: str) -> str:
    rule = load_rules()[code]
    return f"{find_pages_folder().name}/{rule.code}-{rule.name}.md"


def _list_entry(entry: Page | Section) -> Any:
    """Return an entry of the navigation as the generator reads it; the rules are below their index, by family."""
    if isinstance(entry, Page):
        return {entry.title: entry.address} if entry.title else entry.address
    entries = [_list_entry(inner) for inner in entry.entries]
    return {entry.title: [*entries, *([_list_families()] if RULES_INDEX in entry.entries else ())]}


def _list_families() -> Any:
    """The rules by family; the theme folds what is below the second level."""
    rules = load_rules()
    families = {
        f"{family.code}: {family.title}": [
            rule_pages.place_rule(rules[code]) for code in rules if code[:3] == family.code
        ]
        for family in load_families().values()
    }
    return {"By family": [{title: addresses} for title, addresses in families.items()]}


def _write(path: Path, text: str) -> Path:
    _make_room(path).write_text(text, encoding="utf-8", newline="\n")
    return path


def _copy(source: Path, target: Path) -> None:
    shutil.copyfile(source, _make_room(target))


def _pack(folder: str, archive: Path) -> None:
    """Write an archive with a folder; its files begin with the folder's own name."""
    above = Path(folder).parent
    with zipfile.ZipFile(_make_room(archive), "w", zipfile.ZIP_DEFLATED) as packed:
        for path in list_packed_files(folder):
            packed.write(REPOSITORY / path, path.relative_to(above))


def _make_room(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
