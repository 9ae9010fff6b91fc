"""What the rules say about each program that reads models, and whether the tests ask that program itself."""

from __future__ import annotations

from collections import Counter

from truth_page.tables import render_table
from urdfcheck.core import Rule, Verdict
from urdfcheck.policy.consumers import CONSUMERS
from urdfcheck.rules import load_rules
from urdfcheck.simulators.processes import ENGINES

# What `tests/test_simulators.py` asks in each run; it asks the others where URDFCHECK_ENGINES is set.
QUICK = ("pinocchio", "urdfdom", "mujoco", "yourdfpy")
SHOWN = (Verdict.REFUSES, Verdict.DROPS, Verdict.NAN, Verdict.SWAPS, Verdict.REPLACES, Verdict.IGNORES)


def render_engines() -> str:
    """Return a table: for each program, in how many rules it does what at worst, and when it is asked."""
    rows = []
    for name in dict.fromkeys((*CONSUMERS, *ENGINES)):
        counts = Counter(find_worst(rule, name) for rule in load_rules().values())
        told = [counts[verdict] for verdict in SHOWN]
        asked = "each run" if name in QUICK else "on request" if name in ENGINES else "not asked"
        rows.append((name, asked, *told))
    return render_table(("program", "asked by the tests", *map(str, SHOWN)), rows, text_columns=2)


def find_worst(rule: Rule, name: str) -> Verdict:
    """Return the worst that a program does with a defect of a rule, as the page says."""
    sentences = [rule.consumers, *(value for value in rule.consumers.values() if isinstance(value, dict))]
    told = [sentence[name] for sentence in sentences if isinstance(sentence.get(name), str)]
    return max((Verdict.from_sentence(text) for text in told), default=Verdict.LOADS)
