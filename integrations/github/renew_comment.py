"""Writes the comment about a change on its pull request, or renews the one that is there: a step of action.yml.

Standard library only, and no failure: a comment that cannot be written is a notice, because the summary of the job says the same.
The environment gives API, REPOSITORY, NUMBER, TOKEN, COMMENT (a file), VERDICT, and URL and PICTURE (the artifacts with the page
and the picture, where there are any). A comment shows no picture that only readers of the repository may fetch: it has the link.
"""

from __future__ import annotations

import json
import os
import sys
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

MARKER = "<!-- urdfcheck diff -->"
# Comments that are looked through: 100 on each page.
MOST_PAGES = 30
# Seconds.
PATIENCE = 30
# Verdicts that nobody waits for: they renew a comment and begin none.
QUIET = frozenset({"identical", "cosmetic"})


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """The token goes to this server only."""

    def redirect_request(self, *_args: Any, **_names: Any) -> None:
        return None


def call(method: str, path: str, body: object = None) -> Any:
    """Ask the server of the environment.

    :raises OSError: if it does not answer, or refuses.
    :raises ValueError: if the answer is no JSON.
    """
    request = urllib.request.Request(
        f"{os.environ['API']}/repos/{os.environ['REPOSITORY']}/{path}",
        method=method,
        data=None if body is None else json.dumps(body).encode(),
        headers={
            "Authorization": f"Bearer {os.environ['TOKEN']}",
            "Accept": "application/vnd.github+json",
            "Content-Type": "application/json",
            "X-GitHub-Api-Version": "2022-11-28",
        },
    )
    with urllib.request.build_opener(_NoRedirect).open(request, timeout=PATIENCE) as answer:
        return json.load(answer)


def find_comment(number: str) -> int | None:
    """Return the id of the comment of an earlier run. One that a person wrote is left alone, whatever is in it."""
    for page in range(1, MOST_PAGES + 1):
        comments = call("GET", f"issues/{number}/comments?per_page=100&page={page}")
        for comment in comments:
            is_bot = (comment.get("user") or {}).get("type") == "Bot"
            if is_bot and (comment.get("body") or "").startswith(MARKER):
                found: int = comment["id"]
                return found
        if len(comments) < 100:
            break
    return None


def renew_comment() -> str:
    """Write or renew the comment, and return what was done."""
    number = str(int(os.environ["NUMBER"]))
    text = Path(os.environ["COMMENT"]).read_text(encoding="utf-8")
    places = [("in 3D", os.environ.get("URL")), ("as a picture", os.environ.get("PICTURE"))]
    if links := [f"[{name}]({url})" for name, url in places if url]:
        text = f"{text}\nBoth versions {' and '.join(links)}: artifacts of the run.\n"
    known = find_comment(number)
    if known is not None:
        call("PATCH", f"issues/comments/{known}", {"body": text})
        return "renewed"
    if os.environ.get("VERDICT") in QUIET:
        return "not written: the robots are the same"
    call("POST", f"issues/{number}/comments", {"body": text})
    return "written"


def main() -> None:
    """Say what became of the comment."""
    try:
        print(f"comment {renew_comment()}")
    except urllib.error.HTTPError as error:
        hint = "the job needs the permission pull-requests: write, which a pull request from a fork does not get"
        why = hint if error.code in {401, 403, 404} else "the server refuses it"
        print(f"::notice title=urdfcheck diff::no comment ({error.code}): {why}")
    except (OSError, ValueError, KeyError) as error:
        print(f"::notice title=urdfcheck diff::no comment: {type(error).__name__}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
