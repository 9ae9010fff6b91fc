"""The layout of a directed graph from left to right: columns, rows with few crossings, and curves through the columns between.

The steps are those of Sugiyama, Tagawa and Toda (1981): cut loops, assign columns, order the rows of each by their neighbours,
then move each row as near to its neighbours as the order allows.
"""

from __future__ import annotations

import itertools
from bisect import bisect_right
from collections.abc import Mapping, Sequence

from urdfcheck.core.records import dataclass

# Why here and not dagre or elk in the script of the 3D view: the report must show its graphs without JavaScript, when printed
# and under a policy that blocks scripts, so the SVG has to be complete when Python writes it.

# In px: between columns, between rows, between the ends of edges at one box.
COLUMN_GAP, ROW_GAP, PORT_GAP = 48.0, 16.0, 9.0
# Boxes without edges are set in rows at least this wide.
_LEAST_WIDTH = 640.0
# Height of the point at which an edge crosses a column.
_POINT_HEIGHT = 4.0
_SWEEPS = 12


@dataclass(frozen=True, slots=True)
class BoxPosition:
    """The left edge and the middle of the height of a box, in px."""

    x: float
    y: float


@dataclass(frozen=True, slots=True)
class EdgeCurve:
    """An edge of the graph as a line."""

    points: tuple[tuple[float, float], ...]
    """In pairs: straight from the first of a pair to the second, and curved to the next pair."""
    is_reversed: bool
    """Whether the edge was reversed to cut a loop, so that its arrow is at the beginning."""


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """The positions of all boxes and the curves of all edges, in px."""

    positions: tuple[BoxPosition, ...]
    curves: tuple[EdgeCurve, ...]
    """In the order of the edges; an edge from a box to itself has no points."""
    width: float
    height: float


def lay_out_graph(sizes: Sequence[tuple[float, float]], edges: Sequence[tuple[int, int]]) -> GraphLayout:
    """Place boxes of these widths and heights, with edges from the first box of each pair to the second.

    Connected boxes form a group, and the groups are placed one below the other; single boxes follow in rows."""
    positions: dict[int, BoxPosition] = {}
    curves: dict[int, EdgeCurve] = {}
    width, top = 0.0, 0.0
    single_boxes: list[int] = []
    for group in _find_connected_groups(len(sizes), edges):
        if len(group) == 1:
            single_boxes += group
            continue
        layout = _lay_out_group(group, sizes, edges, top=top)
        positions |= layout.positions
        curves |= layout.curves
        width, top = max(width, layout.right), layout.bottom + 2 * ROW_GAP
    x, row_height = 0.0, 0.0
    for box in single_boxes:
        if x and x + sizes[box][0] > max(width, _LEAST_WIDTH):
            x, top, row_height = 0.0, top + row_height + ROW_GAP, 0.0
        positions[box] = BoxPosition(x, top + sizes[box][1] / 2)
        x += sizes[box][0] + 2 * ROW_GAP
        width, row_height = max(width, x - 2 * ROW_GAP), max(row_height, sizes[box][1])
    return GraphLayout(
        positions=tuple(positions[box] for box in range(len(sizes))),
        curves=tuple(curves.get(i, EdgeCurve((), False)) for i in range(len(edges))),
        width=width,
        height=top + row_height if single_boxes else max(0.0, top - 2 * ROW_GAP),
    )


def _find_connected_groups(count: int, edges: Sequence[tuple[int, int]]) -> list[list[int]]:
    """Find the connected groups of boxes; each group, and the groups by their first box, in the order of the boxes."""
    group = list(range(count))

    def find_group_root(box: int) -> int:
        while group[box] != box:
            group[box] = group[group[box]]
            box = group[box]
        return box

    for a, b in edges:
        first, second = sorted((find_group_root(a), find_group_root(b)))
        group[second] = first
    groups: dict[int, list[int]] = {}
    for box in range(count):
        groups.setdefault(find_group_root(box), []).append(box)
    return list(groups.values())


@dataclass(frozen=True, slots=True)
class _GroupLayout:
    """The positions of a group's boxes and the curves of its edges by their numbers, and its right and lower ends."""

    positions: Mapping[int, BoxPosition]
    curves: Mapping[int, EdgeCurve]
    right: float
    bottom: float


@dataclass(frozen=True, slots=True)
class _Routes:
    """Each edge as a path of boxes and of points, one in each column between: a point takes up a row there as a box does."""

    columns: Mapping[int, int]
    """Column of each box and point."""
    heights: Mapping[int, float]
    """Height of each box and point, in px."""
    paths: Mapping[int, Sequence[int]]
    """Boxes and points from the left to the right end of each edge."""


def _lay_out_group(
    group: Sequence[int], sizes: Sequence[tuple[float, float]], edges: Sequence[tuple[int, int]], *, top: float
) -> _GroupLayout:
    """Place one group below ``top``."""
    group_edges = {i: edge for i, edge in enumerate(edges) if edge[0] in group}
    reversed_edges = _find_loop_edges(group, group_edges)
    forward = {i: (b, a) if i in reversed_edges else (a, b) for i, (a, b) in group_edges.items() if a != b}
    routes = _route_edges(group, sizes, forward)
    heights = routes.heights
    rows = _order_rows(routes.columns, list(routes.paths.values()))
    middles = _compute_middles(rows, heights, list(routes.paths.values()))
    lift = top - min(middles[b] - heights[b] / 2 for b in routes.columns)

    widths = [max((sizes[b][0] for b in row if b < len(sizes)), default=0.0) for row in rows]
    lefts = [sum(widths[:c]) + COLUMN_GAP * c for c in range(len(rows))]
    positions = {}
    for box in group:
        c = routes.columns[box]
        x = lefts[c] + (widths[c] - sizes[box][0]) / 2
        positions[box] = BoxPosition(round(x, 1), round(middles[box] + lift, 1))
    begins = _spread_ports(routes.paths, middles, heights)
    ends = _spread_ports({i: path[::-1] for i, path in routes.paths.items()}, middles, heights)
    curves = {}
    for i, path in routes.paths.items():
        points = []
        for b in path:
            # Curves stay between the columns, so that they cross no wider box above or below one of their ends.
            column = routes.columns[b]
            left, right, y = lefts[column], lefts[column] + widths[column], middles[b] + lift
            if b == path[0]:
                left, y = positions[b].x + sizes[b][0], y + begins[i]
            elif b == path[-1]:
                right, y = positions[b].x, y + ends[i]
            points += [(round(left, 1), round(y, 1)), (round(right, 1), round(y, 1))]
        curves[i] = EdgeCurve(tuple(points), i in reversed_edges)
    bottom = max(middles[b] + heights[b] / 2 for b in routes.columns) + lift
    return _GroupLayout(positions, curves, right=lefts[-1] + widths[-1], bottom=bottom)


def _route_edges(
    group: Sequence[int], sizes: Sequence[tuple[float, float]], edges: Mapping[int, tuple[int, int]]
) -> _Routes:
    """Assign columns to the boxes of a group, and points to its edges in the columns between their ends."""
    box_columns = _assign_columns(group, list(edges.values()))
    columns = dict(box_columns)
    heights = {box: sizes[box][1] for box in group}
    paths: dict[int, list[int]] = {}
    for i, (a, b) in edges.items():
        between = [len(sizes) + len(columns) + k for k in range(box_columns[b] - box_columns[a] - 1)]
        for k, point in enumerate(between):
            columns[point], heights[point] = box_columns[a] + 1 + k, _POINT_HEIGHT
        paths[i] = [a, *between, b]
    return _Routes(columns, heights, paths)


def _find_loop_edges(group: Sequence[int], edges: Mapping[int, tuple[int, int]]) -> set[int]:
    """Find the edges that close a loop, depth first."""
    following: dict[int, list[tuple[int, int]]] = {}
    for i, (a, b) in edges.items():
        following.setdefault(a, []).append((i, b))
    targets = {b for _, b in edges.values()}
    state: dict[int, int] = {}  # 1 while the boxes that follow are visited, 2 after that
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
    """Assign each box a column right of all boxes that lead to it; a box without any goes just before those that it leads to."""
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
    """Collect the left and the right neighbours of each box and point on its paths."""
    left: dict[int, list[int]] = {}
    right: dict[int, list[int]] = {}
    for path in paths:
        for a, b in itertools.pairwise(path):
            left.setdefault(b, []).append(a)
            right.setdefault(a, []).append(b)
    return left, right


def _order_rows(of_column: Mapping[int, int], paths: Sequence[Sequence[int]]) -> list[list[int]]:
    """Order the rows of each column: sort by the mean row of the neighbours, forwards and backwards, and keep the best order."""
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
    """Compute how far from the middle of its first box each path leaves it: side by side, in the order of their targets."""
    leaving: dict[int, list[int]] = {}
    for i, path in paths.items():
        leaving.setdefault(path[0], []).append(i)
    offsets = {}
    for box, numbers in leaving.items():
        numbers.sort(key=lambda i: middles[paths[i][1]])
        step = min(PORT_GAP, 0.6 * heights[box] / len(numbers))
        offsets.update({i: (k - (len(numbers) - 1) / 2) * step for k, i in enumerate(numbers)})
    return offsets


def _fit_row_positions(wanted: Sequence[float], heights: Sequence[float]) -> list[float]:
    """Find the positions nearest to the wanted ones (least squares) that keep order and gaps: pool adjacent violators."""
    offsets = [0.0]
    for a, b in itertools.pairwise(heights):
        offsets.append(offsets[-1] + (a + b) / 2 + ROW_GAP)
    pools: list[tuple[float, int]] = []  # mean and number of rows
    for y, offset in zip(wanted, offsets, strict=False):
        mean, count = y - offset, 1
        while pools and pools[-1][0] > mean:
            pool_mean, pool_count = pools.pop()
            mean, count = (pool_mean * pool_count + mean * count) / (pool_count + count), pool_count + count
        pools.append((mean, count))
    means = [mean for mean, count in pools for _ in range(count)]
    return [mean + offset for mean, offset in zip(means, offsets, strict=False)]
