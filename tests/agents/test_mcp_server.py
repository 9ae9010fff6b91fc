"""``urdfcheck mcp`` as a client meets it: the official client of the protocol starts the real command."""

from __future__ import annotations

import asyncio
import shutil
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import FIXTURES
from mcp import Client, StdioServerParameters, stdio_client

pytestmark = [pytest.mark.slow, pytest.mark.long]


def ask(folder: Path, talk: Callable[[Any], Awaitable[Any]]) -> Any:
    """Start the server for a folder, talk to it and end it."""
    words = ["-I", "-m", "urdfcheck", "mcp", str(folder)]

    async def session() -> Any:
        async with Client(stdio_client(StdioServerParameters(command=sys.executable, args=words))) as client:
            return await talk(client)

    return asyncio.run(asyncio.wait_for(session(), 120))


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """One conversation: what each tool answered."""
    folder = tmp_path_factory.mktemp("models")
    shutil.copytree(FIXTURES / "car-3", folder / "car-3")

    async def talk(client: Any) -> dict[str, Any]:
        model = "car-3/urdf/car-3.urdf"
        return {
            "tools": (await client.list_tools()).tools,
            "check": await client.call_tool("check", {"paths": ["car-3"], "select": "SYM001"}),
            "outside": await client.call_tool("check", {"paths": [".."]}),
            "describe": await client.call_tool("describe", {"path": model}),
            "picture": await client.call_tool("picture", {"path": model}),
        }

    result: dict[str, Any] = ask(folder, talk)
    return result


def test_the_tools_say_whether_they_write(answers: dict[str, Any]) -> None:
    reads = {tool.name: tool.annotations.read_only_hint for tool in answers["tools"]}
    writing = {name for name, only_reads in reads.items() if not only_reads}
    assert writing == {"fix"}
    assert {"check", "explain", "compare", "compare_commits", "describe", "picture"} < reads.keys()
    assert all(tool.description for tool in answers["tools"])


def test_findings_arrive_as_text(answers: dict[str, Any]) -> None:
    (content,) = answers["check"].content
    assert "warning SYM001 car-3/urdf/car-3.urdf:88:12" in content.text
    assert answers["check"].structured_content is None  # it would be the same text once more
    assert not answers["check"].is_error


def test_a_mistake_is_an_answer_and_not_the_end(answers: dict[str, Any]) -> None:
    assert answers["outside"].is_error
    assert "start urdfcheck mcp in the folder that is meant" in answers["outside"].content[0].text
    assert answers["describe"].content[0].text.startswith("car-3/urdf/car-3.urdf: 5 links")


def test_a_picture_is_a_picture(answers: dict[str, Any]) -> None:
    (content,) = answers["picture"].content
    assert (content.type, content.mime_type) == ("image", "image/png")
