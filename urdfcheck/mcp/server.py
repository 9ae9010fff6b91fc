"""The tools of :mod:`urdfcheck.mcp.tools` as a server of the Model Context Protocol on standard input and output."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from mcp.server.mcpserver import Image, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.mcp.tools import Workspace
from urdfcheck.version import __version__

INSTRUCTIONS = """\
urdfcheck audits robot models (URDF, xacro, meshes, launch files). Check first. Repair at the place that a finding names: it may
be a macro argument or a property, not the element. Check again, then compare with what there was. What is proven follows from
the file; a hint may be meant: read `explain` before you change what it names. An answer is a page; page=2 has the next."""
_READS = ToolAnnotations(read_only_hint=True, open_world_hint=False)
_WRITES = ToolAnnotations(read_only_hint=False, destructive_hint=True, open_world_hint=False)


def build_server(root: Path) -> MCPServer:
    """Build the server for the models in a folder."""
    workspace = Workspace(root)
    server = MCPServer("urdfcheck", instructions=INSTRUCTIONS, version=__version__)
    # A structured answer would be the same text once more.
    add_reading = server.tool(annotations=_READS, structured_output=False)
    add_writing = server.tool(annotations=_WRITES, structured_output=False)

    @add_reading
    def check(paths: list[str], select: str = "", target: str = "", page: int = 1) -> str:
        """Check robot models, packages or folders. Returns the findings, the worst first, each with an id, its place, evidence,
        cause and edit. select: codes or tags of rules, separated by blanks. target: programs that will read the models
        (gazebo mujoco drake isaac moveit rviz)."""
        with _explained():
            return workspace.check(paths, select, target, page)

    @add_reading
    def explain(rule: str, page: int = 1) -> str:
        """Explain a rule by its code (INR003): what it checks, why it matters, how to fix it, when to ignore it."""
        with _explained():
            return workspace.explain(rule, page)

    @add_writing
    def fix(paths: list[str], ids: list[str], write: bool = False) -> str:
        """Compute the edits of findings by their ids, check the edited files, and return the diff and the findings that remain.
        An edit that makes anything worse is refused. Files are changed only with write=true."""
        with _explained():
            return workspace.fix(paths, ids, write=write)

    @add_reading
    def compare(before: str, after: str, verbose: bool = False, page: int = 1) -> str:
        """Say what the change from one model, package or folder to another does to the robot: motion, limits, mass, shapes.
        verbose: name also what the answer only counts."""
        with _explained():
            return workspace.compare(before, after, verbose=verbose, page=page)

    @add_reading
    def compare_commits(
        revisions: str = "HEAD", paths: list[str] | None = None, verbose: bool = False, page: int = 1
    ) -> str:
        """Say what a change in the git repository does to the robots: REV against the work tree (HEAD: what is not committed),
        or REV..REV."""
        with _explained():
            return workspace.compare_commits(revisions, paths or [], verbose=verbose, page=page)

    @add_reading
    def expand(path: str, words: str = "", page: int = 1) -> str:
        """Say what the expressions of a xacro became and where the numbers in them were typed: property, argument, macro call or
        yaml key. words: part of a place (arm.xacro:12), of an element (link[arm]/inertial) or of an expression (arm_mass)."""
        with _explained():
            return workspace.expand(path, words, page)

    @add_reading
    def describe(path: str, page: int = 1) -> str:
        """Return a robot on one page: its kinematic tree with masses, densities, joint axes and limits, and how far its chains
        reach."""
        with _explained():
            return workspace.describe(path, page)

    @add_reading
    def picture(path: str) -> Image:
        """Return a picture of one robot with its findings marked."""
        with _explained():
            return Image(data=workspace.draw(path), format="png")

    return server


@contextlib.contextmanager
def _explained() -> Iterator[None]:
    """What a person would read is the answer; any other exception stays inside."""
    try:
        yield
    except UrdfcheckError as error:
        raise ToolError(str(error)) from error
