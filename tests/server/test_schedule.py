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
        schedule.note_save()
        await schedule.wait_until_rest()
        return schedule._delays[SOURCE]

    assert asyncio.run(check_once()) == pause
