"""Replacing xacro's functions and containers for the time of one expansion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any


@contextmanager
def replace_attribute(target: Any, name: str, value: Any) -> Iterator[None]:
    """Give an attribute another value for a while (unittest.mock would load asyncio for this).

    A builtin that a module uses (``eval``) is not an attribute of the module; the replacement is deleted afterwards.
    """
    is_own = name in vars(target)
    original = getattr(target, name, None)
    setattr(target, name, value)
    try:
        yield
    finally:
        if is_own:
            setattr(target, name, original)
        else:
            delattr(target, name)


def make_text_type(make_text: Callable[[Any], str]) -> type[str]:
    """Return what takes the place of ``str`` in xacro's own code, where it makes texts of values: ``make_text`` may refuse."""

    class _TextType(type):
        def __instancecheck__(cls, value: Any) -> bool:
            return isinstance(value, str)

        def __call__(cls, value: Any = "") -> str:
            if type(value) is str:
                return value
            return str(value) if isinstance(value, BaseException) else make_text(value)

    class Text(str, metaclass=_TextType):
        pass

    return Text


def make_silent(name: str) -> Callable[..., None]:
    """Return a function that takes the place of one that prints; findings report instead."""

    def print_nothing(*_: Any, **__: Any) -> None:
        pass

    print_nothing.__name__ = name  # xacro exposes these functions to expressions under their own names
    return print_nothing


def limit_property_names(original: Callable[[str], bool]) -> Callable[[str], bool]:
    """Return xacro's ``is_valid_name`` for identifiers only: xacro parses a name as an expression, however long or nested."""
    return lambda name: str.isidentifier(name) and original(name)


class SubstitutionContext(dict[str, Any]):
    """xacro's substitution context, in which ``filename`` is always the file that is being read."""

    def __init__(self, current_file: Callable[[], str]) -> None:
        super().__init__()
        self.current_file = current_file

    def get(self, key: str, default: Any = None) -> Any:
        return self.current_file() if key == "filename" else super().get(key, default)

    def __getitem__(self, key: str) -> Any:
        return self.current_file() if key == "filename" else super().__getitem__(key)


class TracedArguments(dict[str, Any]):
    """xacro's arguments; ``on_read`` is called with the name and value of each one that is read."""

    def __init__(self, values: Mapping[str, str], on_read: Callable[[str, Any], None]) -> None:
        super().__init__(values)
        self.on_read = on_read

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        self.on_read(name, value)
        return value


class ConvertedArguments(dict[str, Any]):
    """xacro's arguments as ``$(eval …)`` reads them: as numbers and truth values where they look like such."""

    def __init__(self, arguments: Mapping[str, str]) -> None:
        super().__init__()
        self.arguments = arguments

    def __missing__(self, name: str) -> Any:
        import xacro.substitution_args as substitution

        return substitution.convert_value(self.arguments[name], "auto")
