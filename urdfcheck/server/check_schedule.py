"""When what is checked: the source tier a moment after each edit, everything on saving or when nothing was typed for a while.

One job runs at a time. An edit interrupts the slow one; at rest, the last job that ran was about the present texts.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from urdfcheck.policy.policy import TIERS
from urdfcheck.server.check_client import CheckClient, CheckProcessError
from urdfcheck.server.check_messages import CheckAnswer, CheckJob, RenameWish
from urdfcheck.server.diagnostics import CheckedState
from urdfcheck.server.documents import DocumentStore, OpenDocument
from urdfcheck.server.index_store import IndexStore
from urdfcheck.source.package.file_kinds import is_launch, is_model, is_srdf, is_yaml
from urdfcheck.source.project_folders import find_project_folder

# Seconds after the last edit: until the source tier is computed, and until everything is. The first pause is the shorter one
# where the last check of an edit was so quick that its findings come within 0.15 s of the key, or little later: to check after
# each key is no use where another follows it, as one that is held does after 0.033 s.
SHORTEST_PAUSE, LONGEST_PAUSE, RESTING = 0.035, 0.1, 1.0
QUICK = 0.15
# Seconds for which a question about a document that was not checked yet waits.
PATIENCE = 20.0
SOURCE = TIERS[0]
# A part of a robot or a robot under another name.
_ROBOT = "<robot"


class CheckSchedule:
    """Runs jobs on the open documents and hands over what they find."""

    def __init__(self, client: CheckClient, documents: DocumentStore, on_change: Callable[[], object]) -> None:
        self.client = client
        self.documents = documents
        self.on_change = on_change
        self.latest: CheckedState | None = None
        """The outcome of the last job."""
        self.complete: CheckedState | None = None
        """The outcome of the last job that computed everything."""
        self.indexes = IndexStore()
        self.problem = ""
        """Why nothing can be checked."""
        self._delays: dict[str | None, float] = {SOURCE: LONGEST_PAUSE, None: RESTING}
        if client.options.tier == SOURCE:  # that is everything
            self._delays = {None: LONGEST_PAUSE}
        self._numbers = 0
        self._timers: dict[str | None, asyncio.TimerHandle] = {}
        self._waiting: set[str | None] = set()
        self._running: str | None = ""  # the tier; empty where nothing runs
        self._forgets = False
        self._only_texts_differ = False
        self._reports = 0  # those that are made
        self._indexed: Mapping[str, str] = {}  # the texts of the indexes, by real path
        self._tasks: set[asyncio.Task[None]] = set()
        self._answered = asyncio.Event()
        self._at_rest = asyncio.Event()
        self._at_rest.set()

    @property
    def states(self) -> list[CheckedState]:
        """The outcomes that are shown, the latest first."""
        older = None if self.complete is self.latest else self.complete
        return [state for state in (self.latest, older) if state is not None]

    def note_edit(self) -> None:
        """Check soon: the text of a document was changed."""
        self._interrupt()
        for tier, seconds in self._delays.items():
            self._set_timer(tier, seconds)

    def note_save(self, *, files_differ: bool = False) -> None:
        """Check everything at once: a document was opened, saved or closed, or a file has changed on the disk.

        ``files_differ``: whether there are other files than before.
        """
        self._forgets = self._forgets or files_differ
        self._only_texts_differ = False
        self._interrupt()
        for tier in self._delays:
            self._set_timer(tier, 0.0)

    async def wait_until_rest(self) -> None:
        """Wait until all that was asked for is checked."""
        await self._at_rest.wait()

    async def wait_until_known(self, document: OpenDocument) -> None:
        """Wait until a document was indexed once, but not for ever: an editor that has just opened it asks only once."""
        with contextlib.suppress(asyncio.TimeoutError):
            while not self.problem and document.real not in self._indexed:
                await asyncio.wait_for(self._answered.wait(), PATIENCE)

    async def find_fixes(self, only: OpenDocument) -> CheckAnswer:
        """Return what the safe fixes change in the model of a document.

        :raises CheckProcessError: if the check process died.
        """
        return await self.client.run_job(self._make_job(None, [only.path], fixes=True))

    async def find_rename(self, wish: RenameWish) -> CheckAnswer:
        """Return the edits of a renaming, or why there are none. It does not wait for the job that computes everything.

        :raises CheckProcessError: if the check process died.
        """
        self._interrupt()
        return await self.client.run_job(self._make_job(None, [wish.path], rename=wish))

    async def make_report(self, document: OpenDocument) -> bytes:
        """Return the report on the robots of a document, as it is when nothing is left to check.

        :raises CheckProcessError: if the check process died, or the project's configuration has an error.
        """
        while True:
            await self.wait_until_rest()
            if self.problem:
                raise CheckProcessError(self.problem)
            self._reports += 1
            try:
                answer = await self.client.run_job(self._make_job(None, [document.path], report=True))
            finally:
                self._reports -= 1
            if answer.failure:
                raise CheckProcessError(answer.failure)
            if not answer.is_cancelled:
                return answer.report

    def _interrupt(self) -> None:
        """End the job that computes everything, or a report; the fast one is rather finished."""
        if (self._running is None and len(self._delays) > 1) or self._reports:
            self.client.cancel()

    # -- jobs ------------------------------------------------------------------------------------------------------

    def _set_timer(self, tier: str | None, seconds: float) -> None:
        if tier in self._timers:
            self._timers.pop(tier).cancel()
        self._at_rest.clear()
        self._timers[tier] = asyncio.get_running_loop().call_later(seconds, self._enqueue, tier)

    def _enqueue(self, tier: str | None) -> None:
        self._timers.pop(tier, None)
        self._waiting.add(tier)
        self._start_next()

    def _start_next(self) -> None:
        if self._running != "":
            return
        if not self._waiting:
            if not self._timers:
                self._at_rest.set()
            return
        tier = SOURCE if SOURCE in self._waiting else None
        self._waiting.discard(tier)
        self._running = tier
        task = asyncio.get_running_loop().create_task(self._run(tier))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _run(self, tier: str | None) -> None:
        texts = {document.real: document.text for document in self.documents.by_uri.values()}
        # While one types, the places of the last index are moved with the text; a new document has none yet.
        has_index = tier is None or not self._indexed.keys() >= texts.keys()
        job = self._make_job(tier, list_checked_paths(self.documents), has_index=has_index)
        if tier == SOURCE:
            # The job that computes everything looks for the models in any case: not every editor tells what happens on the disk.
            job = replace(job, only_texts_differ=self._only_texts_differ)
            self._only_texts_differ = True
        began = time.monotonic()
        try:
            answer = await self.client.run_job(job)
        except CheckProcessError as error:
            if self.client.is_ended:
                return
            self.problem = str(error)
            self._only_texts_differ = False
            self._note_answer()
            self.on_change()
            if self.client.can_start:
                self._waiting.add(tier)
        else:
            self.problem = ""
            if job.only_texts_differ and not answer.is_cancelled:  # others take longer
                self._delays[SOURCE] = choose_pause(time.monotonic() - began)
            self._take_answer(answer, job, texts)
        finally:
            self._running = ""
            self._start_next()

    def _take_answer(self, answer: CheckAnswer, job: CheckJob, texts: Mapping[str, str]) -> None:
        if answer.is_cancelled:
            self._only_texts_differ = False
            if job.tier not in self._timers:  # the interrupt was meant for the job before it
                self._waiting.add(job.tier)
            return
        self.latest = CheckedState(answer=answer, texts=texts)
        if job.tier is None:
            self.complete = self.latest
        if job.index:
            self._indexed = texts
            self.indexes.take_answer(answer, texts)
            self._note_answer()
        self.documents.sources = {
            os.path.realpath(name): text
            for state in reversed(self.states)
            for project in state.answer.projects
            for name, text in project.sources.items()
        }
        self.on_change()

    def _note_answer(self) -> None:
        self._answered.set()
        self._answered = asyncio.Event()

    def _make_job(
        self,
        tier: str | None,
        paths: list[str],
        *,
        has_index: bool = False,
        fixes: bool = False,
        rename: RenameWish | None = None,
        report: bool = False,
    ) -> CheckJob:
        self._numbers += 1
        forgets, self._forgets = self._forgets, False
        return CheckJob(
            number=self._numbers,
            folder=os.getcwd(),
            paths=tuple(paths),
            texts={document.real: document.encode() for document in self.documents.by_uri.values()},
            tier=tier,
            index=has_index,
            forgets=forgets,
            fixes=fixes,
            rename=rename,
            report=report,
        )


def choose_pause(seconds: float) -> float:
    """Return how long to wait for more typing, in s, where the last check after an edit took so many seconds."""
    return SHORTEST_PAUSE if seconds <= QUICK else LONGEST_PAUSE


def list_checked_paths(documents: DocumentStore) -> list[str]:
    """Return the open documents that are checked: models, their parts and launch files.

    Where none of a project is open, its semantic descriptions and yaml files are checked with the robots that they are about.
    Others are only read.
    """
    checked = [document.path for document in documents.by_uri.values() if is_checked(document)]
    others = [document.path for document in documents.by_uri.values() if _is_about_robots(document)]
    projects = {find_project_folder(Path(path)) for path in checked} if others else set()
    return [*checked, *(path for path in others if find_project_folder(Path(path)) not in projects)]


def _is_about_robots(document: OpenDocument) -> bool:
    return is_srdf(Path(document.path)) or is_yaml(Path(document.path))


def is_checked(document: OpenDocument) -> bool:
    """Whether a document is a model, a part of one or a launch file."""
    path = Path(document.path)
    return is_model(path) or is_launch(path) or (path.suffix == ".xml" and _ROBOT in document.text)
