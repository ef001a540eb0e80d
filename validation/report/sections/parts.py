"""What several sections are made of: headings, verdicts, pictures, notes."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable

from validation.comparing.verdicts import DOUBTFUL, FAILED, GOOD
from validation.report.markup import Safe, joined, tag, worded
from validation.report.nouns import Picture


def section(name: str, title: str, *inside: str | None) -> Safe:
    """A section with its heading; `name` is what the table of contents jumps to."""
    return tag("section", tag("h2", title, id=f"{name}-title"), *inside, id=name, aria_labelledby=f"{name}-title")


def verdict(word: str, kind: str = "") -> Safe:
    """A verdict that is seen: one of `validation.comparing.verdicts.VERDICTS`, or another word that is as good as the `kind`."""
    kind = kind or (word if word in (GOOD, DOUBTFUL, FAILED) else "plain")
    return tag("span", word.upper(), class_=f"verdict {kind}") if word else Safe("")


def picture(of: Picture | None) -> Safe:
    """A picture inside the page."""
    if of is None:
        return Safe("")
    width, height = (str(int.from_bytes(of.png[at : at + 4], "big")) for at in (16, 20))  # PNG: its first block says its size
    source = "data:image/png;base64," + b64encode(of.png).decode("ascii")
    image = tag("img", src=source, alt=of.said, width=width, height=height)
    return tag("figure", image, tag("figcaption", of.said), class_="picture")


def notes(sentences: Iterable[str]) -> Safe:
    """Sentences in small print; nothing where there are none."""
    said = [f"{one.rstrip('.')}." for one in sentences if one]
    return tag("div", *(tag("p", worded(one)) for one in said), class_="note") if said else Safe("")


def paragraphs(sentences: Iterable[str | Safe]) -> Safe:
    """One paragraph each."""
    return joined(*(tag("p", worded(one)) for one in sentences))
