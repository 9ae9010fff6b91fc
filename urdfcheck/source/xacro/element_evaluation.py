"""What xacro's ``eval_all`` does with an element: it evaluates the attributes, and then what is in it.

It takes the place of that function, because most attributes and texts hold nothing to evaluate: xacro takes each of them apart.
The functions of xacro that are called here are those with wrappers.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from xml.dom import minidom

from urdfcheck.source.xacro.document_nodes import replace_node

_ELEMENT, _TEXT, _COMMENT = minidom.Node.ELEMENT_NODE, minidom.Node.TEXT_NODE, minidom.Node.COMMENT_NODE
_SWITCH = "xacro:eval-comments"


def evaluate_attributes(node: Any, symbols: Any, *, is_plain: Callable[[Any], bool], pending: list[str]) -> str | None:
    """Evaluate the attributes of an element; return the name of the last one.

    ``is_plain``: whether a text is its own value. ``pending``: gets the name of each other one before it is evaluated.
    """
    import xacro

    last = None
    for name, value in list(node.values.items()):
        if name.startswith("xacro:"):
            node.removeAttribute(name)
            continue
        last = name
        if not is_plain(value):
            pending.append(name)
            node.setAttribute(name, xacro.str(xacro.eval_text(value, symbols)))
    node.values.pop("xmlns:xacro", None)
    return last


def evaluate_content(parent: Any, macros: Any, symbols: Any, *, is_plain: Callable[[Any], bool]) -> None:
    """Evaluate the elements, texts and comments in an element."""
    import xacro

    evaluates_comments = False
    node = parent.firstChild
    while node is not None:
        following = node.nextSibling
        kind = node.nodeType
        if kind == _TEXT:
            if not is_plain(node.data):
                node.data = xacro.str(xacro.eval_text(node.data, symbols))
            evaluates_comments = evaluates_comments and not node.data.strip()
        elif kind == _ELEMENT:
            evaluates_comments = False
            if node.tagName == "xacro:element":
                _rename_element(node, symbols)
                continue  # under its name it may be anything
            _evaluate_element(node, macros, symbols)
        elif kind == _COMMENT and _SWITCH in node.data:
            evaluates_comments = f"{_SWITCH}:off" not in node.data
            replace_node(node, by=None)
        elif kind == _COMMENT and evaluates_comments:
            node.data = xacro.str(xacro.eval_text(node.data, symbols))
        node = following


def _rename_element(node: Any, symbols: Any) -> None:
    import xacro

    name = xacro.eval_text(*xacro.reqd_attrs(node, ["xacro:name"]), symbols=symbols)
    if not name:
        raise xacro.XacroException("xacro:element: empty name")
    node.removeAttribute("xacro:name")
    node.nodeName = node.tagName = name


def _evaluate_element(node: Any, macros: Any, symbols: Any) -> None:
    import xacro

    tag = node.tagName
    if not tag.startswith("xacro:"):
        xacro.eval_all(node, macros, symbols)
    elif tag == "xacro:insert_block":
        _insert_block(node, macros, symbols)
    elif tag == "xacro:include":
        xacro.process_include(node, macros, symbols, xacro.eval_all)
    elif tag == "xacro:property":
        xacro.grab_property(node, symbols)
    elif tag == "xacro:macro":
        xacro.grab_macro(node, macros)
    elif tag == "xacro:arg":
        _declare_argument(node, symbols)
    elif tag == "xacro:attribute":
        _add_attribute(node, symbols)
    elif tag in {"xacro:if", "xacro:unless"}:
        _evaluate_condition(node, macros, symbols)
    else:
        xacro.handle_macro_call(node, macros, symbols)


def _insert_block(node: Any, macros: Any, symbols: Any) -> None:
    import xacro

    (name,) = xacro.check_attrs(node, ["name"], [])
    key = next((key for key in (f"**{name}", f"*{name}") if key in symbols), None)
    if key is None:
        raise xacro.XacroException(f'Undefined block "{name}"')
    block = symbols[key].cloneNode(deep=True)
    xacro.eval_all(block, macros, symbols)
    replace_node(node, by=block, content_only=key.startswith("**"))


def _declare_argument(node: Any, symbols: Any) -> None:
    import xacro

    name, default = xacro.check_attrs(node, ["name", "default"], [])
    arguments = xacro.substitution_args_context["arg"]
    if name not in arguments:
        arguments[name] = xacro.str(xacro.eval_text(default, symbols))
    xacro.remove_previous_comments(node)
    replace_node(node, by=None)


def _add_attribute(node: Any, symbols: Any) -> None:
    import xacro

    name, value = [xacro.eval_text(text, symbols) for text in xacro.reqd_attrs(node, ["name", "value"])]
    if not name:
        raise xacro.XacroException("xacro:attribute: empty name")
    node.parentNode.setAttribute(name, value)
    replace_node(node, by=None)


def _evaluate_condition(node: Any, macros: Any, symbols: Any) -> None:
    import xacro

    xacro.remove_previous_comments(node)
    (condition,) = xacro.check_attrs(node, ["value"], [])
    is_met = xacro.get_boolean_value(xacro.eval_text(condition, symbols), condition)
    if is_met != (node.tagName == "xacro:if"):
        replace_node(node, by=None)
        return
    xacro.eval_all(node, macros, symbols)
    replace_node(node, by=node, content_only=True)
