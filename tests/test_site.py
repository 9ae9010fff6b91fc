"""The pages of the documentation site before they are built: complete, with links for the site, and rules in words."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import REPOSITORY
from output.test_png import decoded
from website import rule_index, rule_pages, rule_pictures
from website.markdown import convert_markdown
from website.navigation import iter_pages
from website.reference_pages import render_exit_codes, render_python_api, render_schemas
from website.source_tree import list_addresses, render_pages
from website.terminal_recording import DARK, LIGHT, Recorded, render_recording

import urdfcheck
from urdfcheck.output.html.sections.appendix import render_rule_pages as render_report_pages
from urdfcheck.output.shared.rule_page import find_rule_address
from urdfcheck.rules import load_rules

SVG = "{http://www.w3.org/2000/svg}"
ADDRESSES = {"docs/fix.md": "guides/fix.md", "rules/README.md": "rules/index.md", "LICENSE": "files/LICENSE.txt"}


def convert(text: str, source: str = "docs/install.md", address: str = "guides/install.md") -> str:
    return convert_markdown(
        text, source=source, address=address, addresses=ADDRESSES, rules={"INR003": "rules/INR003.md"}
    )


@pytest.mark.parametrize(
    ("written", "made"),
    [
        ("[fix](fix.md#how)", "[fix](fix.md#how)"),
        ("[`--fix`](fix.md)", "[`--fix`](fix.md)"),
        ("[rules](../rules/README.md)", "[rules](../rules/index.md)"),
        ("[licence](../LICENSE)", "[licence](../files/LICENSE.txt)"),
        ("[the tests](../tests/cart.py)", "the tests (`tests/cart.py` in the repository)"),
        ("[tests/cart.py](../tests/cart.py)", "tests/cart.py"),
        ("[there](https://example.org/a.md) [here](#part)", "[there](https://example.org/a.md) [here](#part)"),
        ("as INR003 says", "as [INR003](../rules/INR003.md) says"),
        ("`INR003` and XYZ003", "`INR003` and XYZ003"),
        ("[see INR003](fix.md)", "[see INR003](fix.md)"),
        ("## INR003\n", "## INR003\n"),
        ("```\nINR003 [fix](fix.md)\n```", "```\nINR003 [fix](fix.md)\n```"),
        ("````md\n```urdf file=a.urdf\n```\n````", "````md\n```urdf file=a.urdf\n```\n````"),
        ("```console exit=1\n$ false\n```", "```console\n$ false\n```"),
        ("```urdf file=p/a.urdf\n<robot/>\n```", '```xml title="p/a.urdf"\n<robot/>\n```'),
        (
            '```urdf\n<robot>\n  <link/> <!-- expect: INR003 "link" -->\n</robot>\n```',
            '```xml hl_lines="2"\n<robot>\n  <link/>\n</robot>\n```',
        ),
    ],
)
def test_markdown_of_the_repository_becomes_markdown_of_the_site(written: str, made: str) -> None:
    assert convert(written) == made


def test_a_recording_shows_what_was_printed_in_its_colours_and_loads_nothing() -> None:
    printed = "\x1b[1;31m✖ a <b> & c\x1b[0m  plain\n\n  \x1b[2mquiet\x1b[0m\n"
    light, dark = (
        render_recording([Recorded("urdfcheck -q", printed), Recorded("ls", "")], palette, 40, 'two "commands"')
        for palette in (LIGHT, DARK)
    )
    for svg, palette in ((light, LIGHT), (dark, DARK)):
        root = ElementTree.fromstring(svg)
        texts = [element for element in root.iter(f"{SVG}text") if element.text != "$"]
        shown = "".join(str(element.text) for element in texts)
        assert shown == "urdfcheck-q✖ a <b> & cplainquietls"
        error, plain, quiet = texts[-5:-2]
        assert (error.get("class"), error.get("style")) == ("b", f"fill:{palette.colors[1]}")
        assert float(plain.get("x", "")) - float(error.get("x", "")) == 13 * 8
        assert quiet.get("style") == f"fill:{palette.dim}"
        assert float(quiet.get("y", "")) - float(error.get("y", "")) == 2 * 18
        delays = [float(group.get("style", "").partition(":")[2].rstrip("s")) for group in root.iter(f"{SVG}g")]
        assert delays == sorted(delays)
        assert "prefers-reduced-motion: reduce) { g { animation: none; } }" in svg
        assert not re.search(r"url\(|href|@import|<script", svg)
    assert light != dark
    still = render_recording([Recorded("ls", "")], LIGHT, 40, "one", is_still=True)
    assert "animation:" not in still


def test_a_rule_is_no_link_on_its_own_page() -> None:
    assert convert("INR003", "rules/INR003-triangle-inequality.md", "rules/INR003.md") == "INR003"


def test_the_navigation_holds_every_document_once() -> None:
    documents = [path.relative_to(REPOSITORY).as_posix() for path in (REPOSITORY / "docs").rglob("*.md")]
    documents += [path.name for path in REPOSITORY.glob("*.md") if path.name != "README.md"]
    sources = [page.source for page in iter_pages() if page.source]
    assert {*documents} <= {*sources}
    assert len(sources) == len({*sources})
    assert all((REPOSITORY / source).is_file() for source in sources)
    addresses = [*list_addresses().values()]
    assert len(addresses) == len({*addresses})


def test_the_page_of_a_rule_says_in_words_what_its_toml_says() -> None:
    rule = load_rules()["INR003"]
    page = rule_pages.render_rule(rule)
    assert "```toml\nseverity" not in page
    assert "| **repair** | `--fix --unsafe-fixes` repairs it" in page
    assert "| **gives way to** | INR004 on the same element |" in page
    assert '| **mujoco** | <span class="outcome refuses">refuses</span> to compile' in page
    assert "| **pinocchio** | computes the dynamics of an impossible body" in page
    assert "For “<var>link</var>: <var>claim</var>, fixed part (<var>reason</var>)”:" in page
    assert "| `rel_tol` | `1e-9` | Slack relative" in page
    sections = re.findall(r"^## (.+)$", page, re.MULTILINE)
    assert sections[2:7] == ["How to fix", "What it reports", "What each program does", "Options", "Bad"]


def test_the_page_of_a_rule_names_each_finding_by_words() -> None:
    """Also where every word of the headline depends on the robot."""
    page = rule_pages.render_rule(load_rules()["SYM008"])
    assert "\n* <var>wheel</var> and <var>twin</var> are not mirror images" in page
    assert "For “<var>wheel</var> and <var>twin</var> are not mirror images" in page
    assert "\n* endless\n" in rule_pages.render_rule(load_rules()["XAC001"])


def test_the_page_of_a_rule_shows_what_can_be_seen_of_it() -> None:
    """The odd wheel is red; a text, what is a dot in its robot and examples that look alike have no picture."""
    rules = load_rules()
    pictures = rule_pictures.draw_rule(rules["SYM001"])
    assert pictures is not None
    assert pictures.headline.startswith("front_left: zero is")
    red, quiet = (count_marked(picture) for picture in (pictures.bad, pictures.good))
    assert red > quiet
    # Both show four wheels: the Good example is the one that is most like the Bad one.
    assert (decoded(pictures.bad) != decoded(pictures.good)).any(axis=-1).mean() < 0.05
    for code in ("XML004", "INR017", "LCH001", "MSH008"):
        assert rule_pictures.draw_rule(rules[code]) is None, code
    page = rule_pages.render_rule(rules["SYM001"], 'a "b" is off')
    assert '<img src="../../assets/rules/SYM001-bad.png" alt="Bad: a &quot;b&quot; is off"' in page
    assert "What it looks like" not in rule_pages.render_rule(rules["SYM001"])


def test_moments_that_no_box_has_are_compared_as_bars() -> None:
    """The largest is longer than the other two end to end; the Good example has a box."""
    pictures = rule_pictures.draw_rule(load_rules()["INR003"])
    assert pictures is not None
    assert "the red bar is the largest" in pictures.headline
    red = [(p[..., 0] // 2 > p[..., 2]).sum() for p in map(decoded, (pictures.bad, pictures.good))]
    assert red[0] > 1000 > red[1]
    box = rule_pictures.draw_rule(load_rules()["INR005"])
    assert box is not None
    assert "bar" not in box.headline


def count_marked(picture: bytes) -> int:
    """Count the pixels in the red of what a finding is about, which is darker than that of an x axis."""
    pixels = decoded(picture).astype(int)
    assert pixels.shape == (rule_pictures.HEIGHT, rule_pictures.WIDTH, 4)
    red, green, _, opacity = np.moveaxis(pixels, -1, 0)
    return int(((red > 3 * green) & (opacity > 0)).sum())


def test_reports_link_a_rule_where_the_site_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("urdfcheck.version.SITE", "https://example.org/docs/")
    rule = load_rules()["INR003"]
    assert find_rule_address("INR003") == f"https://example.org/docs/{rule_pages.place_rule(rule).removesuffix('.md')}/"
    assert f'<a href="{find_rule_address("INR003")}">page of INR003</a>' in render_report_pages([rule])


def test_every_rule_has_all_of_its_page_and_a_row_in_the_index() -> None:
    index = rule_index.render_index()
    for code, rule in load_rules().items():
        page = rule_pages.render_rule(rule)
        for section in re.findall(r"^## .+$", rule.page, re.MULTILINE):
            assert section in page, code
        for program in rule.consumers:
            assert program in rule.messages or f"\n| **{program}** | " in page, code
        assert not re.search(
            r"\{\w+[^{}]*\}", re.sub(r"```.*?```|`[^`]*`", "", page.partition("## Bad")[0], flags=re.DOTALL)
        ), code
        assert f"\n| [{code}]({code}.md) <small>{rule.name}</small> |" in index


def test_the_index_of_the_rules_names_every_program_that_minds() -> None:
    affected = rule_pages.list_outcomes(load_rules()["LCH001"])
    assert affected == {"rviz": "affected", "roslaunch": "refuses"}
    assert "pinocchio" not in rule_pages.list_outcomes(load_rules()["SYM001"])  # it loads what was typed


def test_every_column_of_a_table_has_a_name() -> None:
    for address, text in render_pages({}).items():
        heads = re.findall(r"^(\|.*\|)\n\|[-:| ]+\|$", text, re.MULTILINE)
        assert not [head for head in heads if "" in map(str.strip, head[1:-1].split("|"))], address


def test_the_reference_names_the_whole_interface() -> None:
    page = render_python_api()
    for name in urdfcheck.__all__:
        assert name.startswith("_") or f"\n## `{name}`\n" in page
    assert "\n    samples: int = 200,\n" in page
    assert "\n* `tier`: how much is computed" in page
    assert "Members: `INFO`, `WARNING`, `ERROR`" in page
    assert "| 3 | nothing to check" in render_exit_codes()
    schemas = render_schemas()
    assert "| `findings` | list of [finding](#report-finding) |" in schemas
    assert "### finding { #report-finding }" in schemas
