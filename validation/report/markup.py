"""HTML that cannot be broken into: whatever is not `Safe` is escaped on its way in.

Titles, names and words come from files of other people; a title with a tag in it is shown with its brackets.
"""

from __future__ import annotations

from html import escape

EMPTY = frozenset({"br", "img", "hr", "meta", "col", "input"})
"""Elements that have no end."""


class Safe(str):
    """HTML that is ready."""

    __slots__ = ()


def tag(name: str, /, *inside: str | None, **attributes: str | bool | None) -> Safe:
    """The element `name` with `inside`, escaped where it is not `Safe`; None leaves out.

    Attributes: `class_` and `for_` lose their underscore, others become dashes; True stands alone, None and False are left out.
    """
    opened = f"<{name}{''.join(_attribute(key, value) for key, value in attributes.items())}>"
    return Safe(opened if name in EMPTY else f"{opened}{joined(*inside)}</{name}>")


def joined(*parts: str | None) -> Safe:
    """`parts` one behind the other, escaped where they are not `Safe`; None leaves out."""
    return Safe("".join(part if isinstance(part, Safe) else escape(part) for part in parts if part is not None))


def worded(text: str) -> Safe:
    """`text` with what stands in back-quotes as code."""
    if isinstance(text, Safe):
        return text
    pieces = text.split("`")
    if len(pieces) % 2 == 0:
        return joined(text)
    return joined(*(tag("code", piece) if k % 2 else piece for k, piece in enumerate(pieces)))


def _attribute(key: str, value: str | bool | None) -> str:
    name = key.rstrip("_").replace("_", "-")
    if value is None or value is False:
        return ""
    return f" {name}" if value is True else f' {name}="{escape(value, quote=True)}"'
