"""Make docs/how-true-is-it.md from the data of the benchmarks: ``python tools/make_truth_page.py``.

Its words are in ``truth_page/template.txt``; every table and every share of the newest round is made.
"""

from __future__ import annotations

from pathlib import Path

from truth_page import editors
from truth_page.engines import render_engines
from truth_page.peers import (
    OWN,
    count_others,
    count_outcomes,
    find_next_best,
    read_results,
    render_asked,
    render_operators,
    render_programs,
    render_sound,
)
from truth_page.rounds import (
    FEWEST,
    count_useful,
    count_wrong,
    list_of,
    read_first_build,
    read_rounds,
    render_bars,
    render_rounds,
    render_rules,
    render_yardstick,
)
from truth_page.tables import copy_summary, copy_table, render_share

PAGE = Path(__file__).parent.parent / "docs" / "how-true-is-it.md"

TEMPLATE = Path(__file__).with_name("truth_page") / "template.txt"


def render_page() -> str:
    """Return the text of the page."""
    results, rounds, answers = read_results(), read_rounds(), editors.read_answers()
    own, other = answers["servers"]
    last = rounds[-1]
    next_name, next_count = find_next_best(results)
    accuracy = "benchmarks/accuracy/README.md"
    return TEMPLATE.read_text(encoding="utf-8").format(
        files=len(results["files"]),
        day=results["date"],
        seconds=results["seconds"],
        own=count_outcomes(results, OWN, "l"),
        next_name=next_name,
        next_count=next_count,
        others=count_others(results),
        programs=render_programs(results),
        sound=render_sound(results),
        operators=render_operators(results),
        asked=render_asked(results),
        editors_day=answers["date"],
        editors_robots=len(answers["published"]),
        editors_read=editors.READ,
        editors_published=editors.render_published(answers, editors.read_judged()),
        editors_planted=len(answers["planted"]),
        editors_own=editors.count_outcomes(answers, own, "l"),
        editors_other=editors.count_outcomes(answers, other, "l"),
        editors_other_name=other,
        editors_defects=editors.render_planted(answers),
        editors_times=editors.render_latency(answers),
        last=last.number,
        last_day=last.day,
        errors=render_share(*count_useful(list_of(last.drawn_labels, "error"))),
        warnings=render_share(*count_useful(list_of(last.drawn_labels, "warning"))),
        wrong=render_share(*count_wrong(last.drawn_labels)),
        bars=render_bars(rounds),
        rounds=render_rounds(rounds),
        yardstick=render_yardstick(next(one for one in rounds if one.number == 15), read_first_build()),
        fewest=FEWEST,
        rules=render_rules(rounds),
        published=copy_table(accuracy, "published robots"),
        shares=copy_table(accuracy, "published robots, shares"),
        made=copy_table(accuracy, "made parts"),
        mobile=copy_table("benchmarks/mobile/README.md", "mobile robots"),
        engines=render_engines(),
        cases=copy_summary("benchmarks/published_cases.md"),
        speed=copy_table("benchmarks/README.md", "speed"),
    )


if __name__ == "__main__":
    PAGE.write_text(render_page(), encoding="utf-8", newline="\n")
