"""Where a Python launch file names frames and joints: static transforms, parameters of nodes, joints to spawn with.

Nothing is executed. A text counts as such a name only where the call that it is typed for says so; all else is a doubt.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.python_launch_file import PythonLaunchReader
from urdfcheck.source.launch.python_texts import find_call_argument, get_function_name
from urdfcheck.source.launch.static_transforms import find_frame_words

LINK, JOINT = "link", "joint"
_NODES = frozenset({"Node", "LifecycleNode", "ComposableNode"})
_PUBLISHER = "static_transform_publisher"
# Programs that place the joints of what they spawn: ``-J name value``.
_SPAWNERS = frozenset({"spawn_entity.py", "spawn_model"})
# Parameters of nodes whose values name a frame or joints: `robot_base_frame`, `child_frame_id`, `left_wheel_names` is neither.
_FRAME_KEY = re.compile(r"(?:\w*_)?frame(?:_id|_name)?")
_JOINT_KEY = re.compile(r"(?:\w*_)?joints?(?:_names?)?")
# The parameters that put a text before the name of each frame.
PREFIX_KEYS = frozenset({"frame_prefix", "tf_prefix"})
# A string as it is typed, without escapes: the quotes and what is between them.
_STRING = re.compile(r"[rRuU]?('''|\"\"\"|'|\")(.*)\1", re.DOTALL)
_WORD = re.compile(r"\S+")
_UNSAID = "nothing says that it names a part of the robot"
_SHARED = "the variable may be used for something else"
_DEEPEST = 8


@dataclass(frozen=True, slots=True)
class NamedText:
    """A text that is a name of a robot's part, or may be one."""

    kind: str
    """link | joint; a link stands for its frame."""
    name: str
    span: Span
    doubt: str = ""
    """Why it may be something else; empty where it is that name."""


def classify_parameter(name: str) -> str:
    """Return what the value of a node's parameter names: a link (its frame) or a joint; empty for all others."""
    return LINK if _FRAME_KEY.fullmatch(name) else JOINT if _JOINT_KEY.fullmatch(name) else ""


def read_named_texts(
    reader: PythonLaunchReader, names: Mapping[str, Collection[str]], model: str
) -> Iterator[NamedText]:
    """Yield the texts of a Python launch file that are or may be a model's names: first those where frames and joints are named.

    ``names``: those of its links and joints by kind; ``model``: its real path. Of a file that does not load the model there are
    no others, and each has that doubt.
    """
    texts = _NamedTexts(reader)
    texts.read()
    doubt = texts.explain_file(model)
    found = [
        NamedText(kind, name, span, doubt or own_doubt)
        for kind, name, span, own_doubt in dict.fromkeys(texts.found)
        if name in names.get(kind, ())
    ]
    yield from sorted(found, key=lambda text: text.span.start)
    for name, span in () if doubt else texts.iter_other_texts():
        if not any(span.start <= text.span.start and text.span.end <= span.end for text in found):
            yield from (NamedText(kind, name, span, _UNSAID) for kind in names if name in names[kind])


class _NamedTexts:
    """Collects the texts of one file that are typed where frames and joints are named."""

    def __init__(self, reader: PythonLaunchReader) -> None:
        self.reader = reader
        self.texts = reader.texts
        self.calls = [node for node in reader.nodes if isinstance(node, ast.Call)]
        self.found: list[tuple[str, str, Span, str]] = []
        # How often a variable with each value is read, and how often that is as a name.
        self.reads = Counter(map(id, self.texts.assigned.values()))
        self.uses: dict[int, list[tuple[str, ast.Constant]]] = {}
        self.prefixes_frames = False

    def read(self) -> None:
        """Read all calls that start programs."""
        for call in self.calls:
            function = get_function_name(call)
            if function in _NODES:
                self.read_node(call)
            elif function == "ExecuteProcess":
                self.read_words("", self.list_words(find_call_argument(call, -1, "cmd")))
        for key, uses in self.uses.items():
            is_name_only = len(uses) == self.reads[key] and len({kind for kind, _ in uses}) == 1
            self.add_text(*uses[0], "" if is_name_only else _SHARED)

    def read_node(self, call: ast.Call) -> None:
        """Read the arguments and parameters of a node."""
        executable = find_call_argument(call, -1, "executable", "node_executable")
        program = "" if executable is None else self.texts.evaluate(executable) or ""
        self.read_words(program, self.list_words(find_call_argument(call, -1, "arguments")))
        for part in self.texts.list_elements(find_call_argument(call, -1, "parameters")):
            self.read_parameters(self.texts.follow_name(part), 0)

    def list_words(self, node: ast.expr | None) -> Sequence[tuple[str, ast.expr | Span]]:
        """Return the words of a list, or of a literal that is split, with where each is typed; empty texts are unknown."""
        node = self.texts.follow_name(node)
        if isinstance(node, ast.Call) and get_function_name(node) == "split" and isinstance(node.func, ast.Attribute):
            typed = node.func.value
            span = self.find_content(typed) if isinstance(typed, ast.Constant) else None
            if span is None:
                return ()
            words = _WORD.finditer(self.reader.file.text, span.start, span.end)
            return [(word[0], self.reader.file.make_span(*word.span())) for word in words]
        return [(self.texts.evaluate(part) or "", part) for part in self.texts.list_elements(node)]

    def read_words(self, program: str, words: Sequence[tuple[str, ast.expr | Span]]) -> None:
        """Read what is typed behind a program: the frames of a static transform, the joints of a spawner."""
        typed = [word for word, _ in words]
        if not program and _PUBLISHER in typed:
            program, words = _PUBLISHER, words[typed.index(_PUBLISHER) + 1 :]
        if program == _PUBLISHER:
            for place in find_frame_words([word for word, _ in words]) or ():
                self.add(LINK, words[place][1])
        elif program in _SPAWNERS:
            for place, word in enumerate(typed[:-1]):
                if word == "-J":
                    self.add(JOINT, words[place + 1][1])

    def read_parameters(self, node: ast.expr | None, depth: int) -> None:
        """Read a dictionary of parameters, and those in it."""
        if not isinstance(node, ast.Dict) or depth > _DEEPEST:
            return
        for key, typed in zip(node.keys, node.values, strict=True):
            value = self.texts.follow_name(typed)
            name = (self.texts.evaluate(key) or "").rpartition(".")[2] if key is not None else ""
            if isinstance(value, ast.Dict):
                self.read_parameters(value, depth + 1)
            elif name in PREFIX_KEYS and not (isinstance(value, ast.Constant) and value.value == ""):
                self.prefixes_frames = True
            kind = classify_parameter(name)
            if kind and isinstance(value, (ast.List, ast.Tuple)):
                for part in value.elts:
                    self.add(kind, part)
            elif kind:
                self.add(kind, typed)

    def add(self, kind: str, place: ast.expr | Span) -> None:
        """Add a text at a place where one names a part of this kind."""
        if isinstance(place, Span):
            self.add_span(kind, place, "")
            return
        if isinstance(place, ast.Call) and get_function_name(place) == "ParameterValue" and place.args:
            place = place.args[0]
        value = self.texts.follow_name(place)
        if isinstance(value, ast.Constant) and value is place:
            self.add_text(kind, value, "")
        elif isinstance(value, ast.Constant) and self.texts.assigned.get(id(place)) is value:
            self.uses.setdefault(id(value), []).append((kind, value))
        elif isinstance(value, ast.Constant):
            self.add_text(kind, value, _SHARED)
        elif isinstance(value, ast.Call) and (argument := self.texts.get_argument_name(value)):
            self.add_default(kind, argument)

    def add_default(self, kind: str, argument: str) -> None:
        """Add the default of an argument of the launch file, which may be used elsewhere too."""
        for call in self.calls:
            name = find_call_argument(call, 0, "name") if get_function_name(call) == "DeclareLaunchArgument" else None
            default = self.texts.follow_name(find_call_argument(call, 1, "default_value"))
            if name is not None and self.texts.evaluate(name) == argument and isinstance(default, ast.Constant):
                self.add_text(kind, default, "it is the default of a launch argument, which other files may read")

    def add_text(self, kind: str, node: ast.Constant, doubt: str) -> None:
        span = self.find_content(node)
        if span is not None:
            self.add_span(kind, span, doubt)

    def add_span(self, kind: str, span: Span, doubt: str) -> None:
        text = self.reader.file.text[span.start : span.end]
        name = text.lstrip("/") if kind == LINK else text  # tf drops the slash before a frame
        place = self.reader.file.make_span(span.end - len(name), span.end)
        self.found.append((kind, name, place, doubt))

    def find_content(self, node: ast.Constant) -> Span | None:
        """Return what is between the quotes of a string; None for one with escapes, and for several in a row."""
        span = self.reader.locate_expression(node).span if isinstance(node.value, str) else None
        match = None if span is None else _STRING.fullmatch(self.reader.file.text[span.start : span.end])
        if span is None or match is None or match[2] != node.value:
            return None
        return self.reader.file.make_span(span.start + match.start(2), span.start + match.end(2))

    def iter_other_texts(self) -> Iterator[tuple[str, Span]]:
        """Yield all strings of the file."""
        for node in self.reader.nodes:
            span = self.find_content(node) if isinstance(node, ast.Constant) else None
            if span is not None:
                yield self.reader.file.text[span.start : span.end], span

    def explain_file(self, model: str) -> str:
        """Return why nothing in the file is certainly about a model, given by its real path; empty where it loads only that."""
        loaded = self.reader.read().list_real_models()
        if model not in loaded:
            return "the launch file does not load the robot"
        if len(loaded) > 1:
            return "the launch file loads several models"
        return "a prefix is put before the frames" if self.prefixes_frames else ""
