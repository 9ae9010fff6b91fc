"""KIN004 reports joints that form a cycle."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.link_graph import KinematicGraph

_SHOWN = 12
# urdfdom makes the links of a loop each other's children, however the tree leads to them: what walks the tree never ends.
_ENTERED = {
    "urdfdom": "loads it with links that are their own ancestors",
    "pinocchio": "refuses the file, or crashes",
}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    children = {joint.child for joint in model.joints}
    rooted = any(link.name not in children for link in model.links)
    repeated = {name for name, count in Counter(link.name for link in model.links).items() if count > 1}
    loss = "drops the loop without a message" if rooted else "refuses the file: no root link found"
    for loop in KinematicGraph.from_model(model).find_loops():
        closing = loop[-1]
        links = [joint.parent for joint in loop]
        is_entered = any(joint.child in links and joint not in loop for joint in model.joints)
        shown = [*links[:_SHOWN], "…"] if len(links) > _SHOWN else links
        yield rule.finding(
            "loop",
            at=closing.child_attribute or closing,
            related=loop[:-1][:_SHOWN],
            consequences=_ENTERED if rooted and is_entered else {"urdfdom": loss, "bullet": loss},
            joint=closing.name,
            loop=" → ".join([*shown, links[0]]),
            links=links,
            # Which of two links of one name a joint means is open: the loop may be that mistake only.
            between=[f"link[{name}]" for name in links if name in repeated],
        )
