"""What the site holds: its pages with their addresses, in the order of the navigation, and files that are copied as they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent.parent


@dataclass(frozen=True)
class Page:
    """A page of the site."""

    address: str
    """Its Markdown file in the folder of the site: ``guides/fix.md`` is read at ``/guides/fix/``."""
    source: str = ""
    """The file of the repository that it is made from; empty if a function makes it."""
    title: str = ""
    """What the navigation calls it; empty: its heading."""


@dataclass(frozen=True)
class Section:
    """Pages under a title."""

    title: str
    entries: tuple[Page | Section, ...]


START = Page("index.md", title="Overview")
SAMPLE = Page("sample/index.md", title="Sample report")
RULES_INDEX = Page("rules/index.md", "rules/README.md")
CONFIGURATION = Page("reference/configuration.md", "docs/configuration-keys.md")
DEMOS = Page("guides/demos.md", "fixtures/demos/README.md")
EXIT_CODES = Page("reference/exit-codes.md")
PYTHON_API = Page("reference/python-api.md")
SCHEMAS = Page("reference/json.md")
TRUTH = Page("how-true-is-it.md", "docs/how-true-is-it.md")

# The rules follow their index; `rule_pages` adds them.
NAVIGATION = (
    START,
    Section(
        "Guides",
        (
            Page("guides/index.md", "docs/README.md", "All guides"),
            Section(
                "Check my robot",
                (
                    Page("guides/first-robot.md", "docs/guides/first-robot.md", "The first ten minutes"),
                    Page("guides/install.md", "docs/install.md"),
                    Page("guides/reports.md", "docs/reports.md", "Read the report"),
                    Page("guides/inertia.md", "docs/guides/inertia.md"),
                    Page("guides/editors.md", "docs/editors.md"),
                    Page("guides/variants.md", "docs/variants.md"),
                ),
            ),
            Section(
                "Fix what it found",
                (
                    Page("guides/fix.md", "docs/guides/fix.md", "Repair the files"),
                    Page("guides/repair.md", "docs/repair.md"),
                    Page("guides/exporters.md", "docs/guides/exporters.md"),
                    Page("guides/suppress.md", "docs/suppress.md"),
                ),
            ),
            Section(
                "Adopt it on a messy repository",
                (
                    Page("guides/adopt.md", "docs/guides/adopt.md", "Accept today's findings"),
                    Page("guides/configure.md", "docs/configure.md"),
                ),
            ),
            Section(
                "Gate a pull request",
                (
                    Page("guides/pull-request.md", "docs/guides/pull-request.md", "Two questions"),
                    Page("guides/continuous-integration.md", "docs/continuous-integration.md"),
                    Page("guides/strangers-models.md", "docs/guides/strangers-models.md"),
                    Page("guides/integrations.md", "integrations/README.md"),
                ),
            ),
            Section(
                "See what a change does",
                (
                    Page("guides/see-a-change.md", "docs/guides/see-a-change.md", "Two edits"),
                    Page("guides/diff.md", "docs/diff.md"),
                ),
            ),
            Section(
                "Prepare a model for a simulator",
                (
                    Page("guides/prepare.md", "docs/guides/simulators.md", "MuJoCo, Drake, Gazebo, Isaac Sim"),
                    Page("guides/simulators.md", "docs/simulators.md"),
                    Page("guides/moveit.md", "docs/moveit.md"),
                ),
            ),
            Section(
                "Check thousands of models",
                (
                    Page("guides/thousands-of-models.md", "docs/guides/thousands-of-models.md"),
                    Page("guides/cache.md", "docs/cache.md"),
                    Page("guides/python.md", "docs/python.md"),
                ),
            ),
            Section(
                "Robots to practise on",
                (
                    DEMOS,
                    Page("guides/demo-arm.md", "fixtures/demos/arm.md"),
                    Page("guides/demo-humanoid.md", "fixtures/demos/humanoid.md"),
                    Page("guides/demo-mobile-manipulator.md", "fixtures/demos/mobile_manipulator.md"),
                    Page("guides/demo-quadruped.md", "fixtures/demos/quadruped.md"),
                ),
            ),
            Section(
                "Use it with other programs",
                (Page("guides/agents.md", "docs/agents.md"),),
            ),
        ),
    ),
    Section("Rules", (RULES_INDEX,)),
    Section(
        "Reference",
        (
            Page("reference/command-line.md", "docs/command-line.md"),
            CONFIGURATION,
            EXIT_CODES,
            PYTHON_API,
            SCHEMAS,
            Page("reference/limits.md", "docs/limits.md"),
            Page("reference/glossary.md", "docs/glossary.md"),
            Page("reference/changelog.md", "CHANGELOG.md"),
        ),
    ),
    SAMPLE,
    TRUTH,
    Section(
        "Project",
        (
            Page("project/contributing.md", "CONTRIBUTING.md"),
            Page("project/releasing.md", "docs/releasing.md"),
            Page("project/what-a-check-can-ask.md", "docs/what-a-check-can-ask.md"),
            Page("project/security.md", "SECURITY.md"),
            Page("project/code-of-conduct.md", "CODE_OF_CONDUCT.md"),
            Page("project/hostile.md", "fixtures/hostile/README.md"),
            Section(
                "Measured",
                (
                    Page("project/benchmarks.md", "benchmarks/README.md"),
                    Page("project/accuracy.md", "benchmarks/accuracy/README.md"),
                    Page("project/accuracy-judged.md", "benchmarks/accuracy/judged/README.md"),
                    Page("project/rivals.md", "benchmarks/rivals/README.md"),
                    Page("project/language-servers.md", "benchmarks/language_servers/README.md"),
                    Page("project/changes.md", "benchmarks/diff/README.md"),
                    Page("project/mobile.md", "benchmarks/mobile/README.md"),
                    Page("project/published-cases.md", "benchmarks/published_cases.md"),
                    Page("project/readability.md", "benchmarks/readability.md"),
                ),
            ),
        ),
    ),
)

# Files that readers copy or programs read, by their places in the repository: patterns of pathlib.
COPIED = (
    "urdfcheck/output/*.schema.json",
    "integrations/**/*",
    "action.yml",
    ".pre-commit-hooks.yaml",
    "LICENSE",
    "reports/car-3.json",
    "reports/car-3.md",
    "reports/car-3.png",
    "reports/car-3*.txt",
)
# Folders that readers copy as a whole: a link to one leads to an archive of it.
PACKED = ("integrations/ament", "integrations/ros2", "integrations/vscode", "fixtures/car-3", "fixtures/car-3-fixed")


def iter_pages(entries: tuple[Page | Section, ...] = NAVIGATION) -> Iterator[Page]:
    """Yield all pages of the navigation in its order."""
    for entry in entries:
        if isinstance(entry, Section):
            yield from iter_pages(entry.entries)
        else:
            yield entry


def list_copied_files() -> dict[str, str]:
    """Return the addresses of the files that are copied, by their paths in the repository."""
    pages = {page.source for page in iter_pages()}
    found = _find_files(COPIED)
    return {path.as_posix(): _place_file(path) for path in found if path.as_posix() not in pages}


def list_archives() -> dict[str, str]:
    """Return the addresses of the archives, by the folders that they hold."""
    return {folder: f"files/{folder}.zip" for folder in PACKED}


def list_packed_files(folder: str) -> list[Path]:
    """Return the files of a folder, relative to the repository."""
    return _find_files((f"{folder}/**/*",))


def _find_files(patterns: Iterable[str]) -> list[Path]:
    files = sorted({path for pattern in patterns for path in REPOSITORY.glob(pattern) if path.is_file()})
    return [path.relative_to(REPOSITORY) for path in files if "__pycache__" not in path.parts]


def _place_file(path: Path) -> str:
    """Return the address of a file: hidden files are not published, and Markdown would become a page."""
    name = path.name.lstrip(".") + (".txt" if path.suffix in ("", ".md") else "")
    return f"files/{path.with_name(name).as_posix()}"
