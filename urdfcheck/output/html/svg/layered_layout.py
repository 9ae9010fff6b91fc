"""A directed graph from left to right: columns, rows with few crossings, and curves that run through the columns between.

The steps are those of Sugiyama, Tagawa and Toda (1981): cut loops, assign columns, order the rows of each by their neighbours,
then move each row as near to its neighbours as the order allows.
"""

from __future__ import annotations

import itertools
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

COLUMN_GAP, ROW_GAP, PORT_GAP = 48.0, 16.0, 9.0
_SWEEPS = 12


@dataclass(frozen=True, slots=True)
class BoxPosition:
    """The left edge and the middle of the height of a box, in px."""

    x: float
    y: float


@dataclass(frozen=True, slots=True)
class EdgeCurve:
    """An edge: points in pairs, straight from the first of a pair to the second, and curved to the next pair. ``back``: it was
    turned round to cut a loop, so that its arrow stands at its beginning."""

    points: tuple[tuple[float, float], ...]
    is_reversed: bool


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """Where everything goes. ``curves`` in the order of the edges; one from a box to itself has no points."""

    positions: tuple[BoxPosition, ...]
    curves: tuple[EdgeCurve, ...]
    width: float
    height: float


def lay_out_graph(sizes: Sequence[tuple[float, float]], edges: Sequence[tuple[int, int]]) -> GraphLayout:
    """Boxes of these widths and heights, each edge from the first box to the second. What hangs together is drawn together, one
    such group below the other."""
    places: dict[int, BoxPosition] = {}
    curves: dict[int, EdgeCurve] = {}
    width, top = 0.0, 0.0
    alone: list[int] = []
    for group in _find_connected_groups(len(sizes), edges):
        if len(group) == 1:
            alone += group
            continue
        right, bottom = _lay_out_group(group, sizes, edges, top, places, curves)
        width, top = max(width, right), bottom + 2 * ROW_GAP
    x, row = 0.0, 0.0
    for box in alone:  # in rows, as wide as the rest
        if x and x + sizes[box][0] > max(width, 640.0):
            x, top, row = 0.0, top + row + ROW_GAP, 0.0
        places[box] = BoxPosition(x, top + sizes[box][1] / 2)
        x += sizes[box][0] + 2 * ROW_GAP
        width, row = max(width, x - 2 * ROW_GAP), max(row, sizes[box][1])
    height = top + row if alone else max(0.0, top - 2 * ROW_GAP)
    return GraphLayout(
        tuple(places[box] for box in range(len(sizes))),
        tuple(curves.get(i, EdgeCurve((), False)) for i in range(len(edges))),
        width,
        height,
    )


def _find_connected_groups(count: int, edges: Sequence[tuple[int, int]]) -> list[list[int]]:
    """What hangs together, each group and the groups in the order of their numbers."""
    group = list(range(count))

    def find_group_root(box: int) -> int:
        while group[box] != box:
            group[box] = group[group[box]]
            box = group[box]
        return box

    for a, b in edges:
        first, second = sorted((find_group_root(a), find_group_root(b)))
        group[second] = first
    found: dict[int, list[int]] = {}
    for box in range(count):
        found.setdefault(find_group_root(box), []).append(box)
    return list(found.values())


def _lay_out_group(
    group: Sequence[int],
    sizes: Sequence[tuple[float, float]],
    edges: Sequence[tuple[int, int]],
    top: float,
    positions: dict[int, BoxPosition],
    curves: dict[int, EdgeCurve],
) -> tuple[float, float]:
    """Place one group below ``top``: its right and lower end."""
    own = {i: e for i, e in enumerate(edges) if e[0] in group}
    back = _find_loop_edges(group, own)
    forward = {i: (b, a) if i in back else (a, b) for i, (a, b) in own.items() if a != b}
    columns = _assign_columns(group, list(forward.values()))
    # An edge over several columns gets a point in each: it takes its row there as a box does.
    heights = {box: sizes[box][1] for box in group}
    of_column: dict[int, int] = dict(columns)
    paths: dict[int, list[int]] = {}
    for i, (a, b) in forward.items():
        between = [len(sizes) + len(of_column) + k for k in range(columns[b] - columns[a] - 1)]
        for k, point in enumerate(between):
            of_column[point], heights[point] = columns[a] + 1 + k, 4.0
        paths[i] = [a, *between, b]
    rows = _order_rows(of_column, list(paths.values()))
    middles = _compute_middles(rows, heights, list(paths.values()))
    lift = top - min(middles[b] - heights[b] / 2 for b in of_column)
    widths = [max((sizes[b][0] for b in row if b < len(sizes)), default=0.0) for row in rows]
    lefts = [sum(widths[:c]) + COLUMN_GAP * c for c in range(len(rows))]
    for box in group:
        c = columns[box]
        positions[box] = BoxPosition(
            round(lefts[c] + (widths[c] - sizes[box][0]) / 2, 1), round(middles[box] + lift, 1)
        )
    begins = _spread_ports(paths, middles, heights)
    ends = _spread_ports({i: path[::-1] for i, path in paths.items()}, middles, heights)
    for i, path in paths.items():
        points = []
        for b in path:
            # Curves stay between the columns: a wider box above or below the end of one is not crossed.
            left, right = lefts[of_column[b]], lefts[of_column[b]] + widths[of_column[b]]
            y = middles[b] + lift
            if b == path[0]:
                left, y = positions[b].x + sizes[b][0], y + begins[i]
            elif b == path[-1]:
                right, y = positions[b].x, y + ends[i]
            points += [(round(left, 1), round(y, 1)), (round(right, 1), round(y, 1))]
        curves[i] = EdgeCurve(tuple(points), i in back)
    bottom = max(middles[b] + heights[b] / 2 for b in of_column) + lift
    return lefts[-1] + widths[-1], bottom


def _find_loop_edges(group: Sequence[int], edges: Mapping[int, tuple[int, int]]) -> set[int]:
    """The edges that close a loop, found depth first."""
    following: dict[int, list[tuple[int, int]]] = {}
    for i, (a, b) in edges.items():
        following.setdefault(a, []).append((i, b))
    targets = {b for _, b in edges.values()}
    state: dict[int, int] = {}  # 1 while what follows is looked at, 2 after that
    closing: set[int] = set()
    for start in (*(b for b in group if b not in targets), *group):
        stack = [(start, iter(following.get(start, ())))] if start not in state else []
        if stack:
            state[start] = 1
        while stack:
            box, rest = stack[-1]
            step = next(rest, None)
            if step is None:
                state[box] = 2
                stack.pop()
            elif state.get(step[1]) == 1:
                closing.add(step[0])
            elif step[1] not in state:
                state[step[1]] = 1
                stack.append((step[1], iter(following.get(step[1], ()))))
    return closing


def _assign_columns(group: Sequence[int], edges: Sequence[tuple[int, int]]) -> dict[int, int]:
    """Each box right of all that lead to it; one that nothing leads to just before what it leads to."""
    columns = dict.fromkeys(group, 0)
    for _ in group:
        moved = False
        for a, b in edges:
            if columns[b] <= columns[a]:
                columns[b], moved = columns[a] + 1, True
        if not moved:
            break
    targets = {b for _, b in edges}
    for box in group:
        if box not in targets:
            columns[box] = min((columns[b] for a, b in edges if a == box), default=1) - 1
    return columns


def _collect_neighbours(paths: Sequence[Sequence[int]]) -> tuple[dict[int, list[int]], dict[int, list[int]]]:
    """What stands left and right of each on its paths."""
    left: dict[int, list[int]] = {}
    right: dict[int, list[int]] = {}
    for path in paths:
        for a, b in itertools.pairwise(path):
            left.setdefault(b, []).append(a)
            right.setdefault(a, []).append(b)
    return left, right


def _order_rows(of_column: Mapping[int, int], paths: Sequence[Sequence[int]]) -> list[list[int]]:
    """The rows of each column: to and fro, each by the middle of its neighbours in the column before; the best of all orders."""
    rows: list[list[int]] = [[] for _ in range(max(of_column.values()) + 1)]
    for box, column in of_column.items():
        rows[column].append(box)
    left, right = _collect_neighbours(paths)
    best, fewest = [list(row) for row in rows], _count_crossings(rows, right)
    for sweep in range(_SWEEPS):
        beside = right if sweep % 2 else left
        for row in reversed(rows) if sweep % 2 else rows:
            at = {b: k for other in rows for k, b in enumerate(other)}
            row.sort(key=lambda b: (sum(at[n] for n in beside[b]) / len(beside[b])) if b in beside else at[b])
        crossings = _count_crossings(rows, right)
        if crossings < fewest:
            best, fewest = [list(row) for row in rows], crossings
    return best


def _count_crossings(rows: Sequence[Sequence[int]], right: Mapping[int, Sequence[int]]) -> int:
    count = 0
    for row, following in itertools.pairwise(rows):
        at = {b: k for k, b in enumerate(following)}
        ends = [at[n] for b in row for n in sorted(right.get(b, ()), key=at.__getitem__)]
        before: list[int] = []
        for end in ends:
            place = bisect_right(before, end)
            count += len(before) - place
            before.insert(place, end)
    return count


def _compute_middles(
    rows: Sequence[Sequence[int]], heights: Mapping[int, float], paths: Sequence[Sequence[int]]
) -> dict[int, float]:
    left, right = _collect_neighbours(paths)
    middles: dict[int, float] = {}
    for row in rows:
        y = 0.0
        for box in row:
            middles[box] = y + heights[box] / 2
            y += heights[box] + ROW_GAP
    for sweep in range(_SWEEPS):
        for row in reversed(rows) if sweep % 2 else rows:
            wanted = []
            for box in row:
                beside = [*left.get(box, ()), *right.get(box, ())]
                wanted.append(sum(middles[n] for n in beside) / len(beside) if beside else middles[box])
            for box, y in zip(row, _fit_row_positions(wanted, [heights[b] for b in row]), strict=True):
                middles[box] = y
    return middles


def _spread_ports(
    paths: Mapping[int, Sequence[int]], middles: Mapping[int, float], heights: Mapping[int, float]
) -> dict[int, float]:
    """How far from the middle of its first box each path leaves it: side by side, in the order of where they lead."""
    leaving: dict[int, list[int]] = {}
    for i, path in paths.items():
        leaving.setdefault(path[0], []).append(i)
    found = {}
    for box, own in leaving.items():
        own.sort(key=lambda i: middles[paths[i][1]])
        step = min(PORT_GAP, 0.6 * heights[box] / len(own))
        found.update({i: (k - (len(own) - 1) / 2) * step for k, i in enumerate(own)})
    return found


def _fit_row_positions(wanted: Sequence[float], heights: Sequence[float]) -> list[float]:
    """The places nearest to the wanted ones (least squares) that keep the order and the gaps: pool adjacent violators."""
    offsets = [0.0]
    for a, b in itertools.pairwise(heights):
        offsets.append(offsets[-1] + (a + b) / 2 + ROW_GAP)
    pools: list[tuple[float, int]] = []  # mean and number
    for y, offset in zip(wanted, offsets, strict=False):
        mean, number = y - offset, 1
        while pools and pools[-1][0] > mean:
            before, many = pools.pop()
            mean, number = (before * many + mean * number) / (many + number), many + number
        pools.append((mean, number))
    flat = [mean for mean, number in pools for _ in range(number)]
    return [y + offset for y, offset in zip(flat, offsets, strict=False)]
