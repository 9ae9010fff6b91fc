"""When the server checks: after a pause that is as long as the check itself, within limits."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import cast

import pytest

from urdfcheck.run.request import RunOptions
from urdfcheck.server.check_client import CheckClient
from urdfcheck.server.check_messages import CheckAnswer, CheckJob
from urdfcheck.server.check_schedule import LONGEST_PAUSE, SHORTEST_PAUSE, SOURCE, CheckSchedule
from urdfcheck.server.documents import DocumentStore


@pytest.mark.parametrize(("seconds", "pause"), [(0.0, SHORTEST_PAUSE), (0.3, LONGEST_PAUSE)])
def test_the_pause_is_short_where_a_check_is_quick(seconds: float, pause: float) -> None:
    async def check_once() -> float:
        async def run_job(job: CheckJob) -> CheckAnswer:
            await asyncio.sleep(seconds if job.tier == SOURCE else 0)
            return CheckAnswer(number=job.number)

        client = cast(
            CheckClient, SimpleNamespace(options=RunOptions(), run_job=run_job, can_start=True, is_ended=False)
        )
        schedule = CheckSchedule(client, DocumentStore(()), lambda: None)
        for note in (schedule.note_save, schedule.note_edit):
            note()
            await schedule.wait_until_rest()
        return schedule._delays[SOURCE]

    assert asyncio.run(check_once()) == pause


def test_models_are_searched_anew_at_rest_and_where_more_than_a_text_may_differ() -> None:
    """Not every editor tells what happens on the disk, so that what is shown at rest does not depend on it."""
    jobs: list[CheckJob] = []

    async def run_job(job: CheckJob) -> CheckAnswer:
        jobs.append(job)
        return CheckAnswer(number=job.number, is_cancelled=len(jobs) == 7)

    async def check_often() -> None:
        client = cast(
            CheckClient, SimpleNamespace(options=RunOptions(), run_job=run_job, can_start=True, is_ended=False)
        )
        schedule = CheckSchedule(client, DocumentStore(()), lambda: None)
        for note in (schedule.note_save, schedule.note_edit, schedule.note_save, schedule.note_edit):
            note()
            await schedule.wait_until_rest()

    asyncio.run(check_often())
    assert [(job.tier, job.only_texts_differ) for job in jobs] == [
        *((SOURCE, False), (None, False)),
        *((SOURCE, True), (None, False)),
        *((SOURCE, False), (None, False)),
        *((SOURCE, True), (SOURCE, False), (None, False)),  # the first of them was interrupted
    ]
