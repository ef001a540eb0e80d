"""README.md and the pages under docs, read as a reader sees them: blocks, links, pictures, headings, commands within a sentence.

The tests of the pages and the site that is built of them (`tools.site`) both read through here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
FIRST = "index.md"
"""The page under docs that leads to all others."""

_FENCE = re.compile(r"^(?P<fence>```+|~~~+)(?P<language>[^\n`]*)\n(?P<text>.*?)^(?P=fence)[ ]*$", re.MULTILINE | re.DOTALL)
_LINK_OR_CODE = re.compile(r"(?P<picture>!?)\[(?P<text>(?:[^\[\]]|\[[^\[\]]*\])*)\]\((?P<target>[^)\s]+)\)|`[^`]+`")
"""Code that looks like a link is none; a link whose text is code is one."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A fenced block.

    Attributes
    ----------
    language : what stands behind the fence, such as ``sh``; empty where nothing does
    text : its lines, as they stand
    line : number of the line of the opening fence, from 1
    """

    language: str
    text: str
    line: int


@dataclass(frozen=True, kw_only=True)
class Link:
    """What a page points to.

    Attributes
    ----------
    text : what is shown; of a picture what is said in its stead
    target : as written, relative to the page
    picture : whether it is shown rather than led to
    """

    text: str
    target: str
    picture: bool

    @property
    def outside(self) -> bool:
        """Whether it leads to the network."""
        return bool(re.match(r"[a-z]+:", self.target))


def pages(root: Path = ROOT) -> tuple[Path, ...]:
    """README.md and every page under docs."""
    return (root / "README.md", *sorted(root.glob("docs/*.md")))


def blocks(page: Path) -> tuple[Block, ...]:
    """The fenced blocks of `page`, in order."""
    text = page.read_text(encoding="utf-8")
    return tuple(
        Block(language=found["language"].strip(), text=found["text"], line=text.count("\n", 0, found.start()) + 1)
        for found in _FENCE.finditer(text)
    )


def prose(page: Path) -> str:
    """The text of `page` without its fenced blocks."""
    return _FENCE.sub("", page.read_text(encoding="utf-8"))


def indented(page: Path) -> tuple[str, ...]:
    """Lines that stand as code because they are indented by four blanks and begin a block: formulas and quotations."""
    return tuple(
        line
        for paragraph in re.split(r"\n[ ]*\n", prose(page))
        for line in paragraph.splitlines()
        if paragraph.lstrip("\n").startswith("    ")
    )


def commands(page: Path) -> tuple[str, ...]:
    """The lines of all blocks marked ``sh``, without empty lines and whole-line comments."""
    return tuple(line for block in blocks(page) if block.language == "sh" for line in lines(block))


def lines(block: Block) -> tuple[str, ...]:
    """The commands of a block, one a line."""
    return tuple(line.strip() for line in block.text.splitlines() if line.strip() and not line.startswith("#"))


def quoted(page: Path) -> tuple[str, ...]:
    """What stands between single back-quotes in the prose of `page`, broken lines joined."""
    return tuple(" ".join(words.split()) for words in re.findall(r"(?<!`)`([^`]+)`(?!`)", prose(page)))


def links(page: Path) -> tuple[Link, ...]:
    """Links and pictures of `page`, in order."""
    return tuple(
        Link(text=found["text"], target=found["target"], picture=bool(found["picture"]))
        for found in _LINK_OR_CODE.finditer(prose(page))
        if found["target"]
    )


WORDS = {
    "base-excitation": "base excitation|base-excited",
    "fmd": "FMDs?",
    "campaign": "campaigns?",
    "tare": "tares?",
    "response-function": "response functions?",
    "dynamic-mass": "dynamic mass(?:es)?",
    "mass-line": r"(?<!dynamic\s)mass lines?",
    "sound-laboratory": "sound laborator(?:y|ies)",
    "plain-error": "plain errors?",
    "used-only-for-checking": "used only for checking|only for checking|held[ -]out|hold out",
    "sigma": "sigmas?",
    "chi-squared": "chi²|χ²",
    "prior-penalty": "prior penalt(?:y|ies)",
    "evidence": "nats?",
    "mac": "MAC",
    "detection-limit": "detection limits?",
    "leftover": "leftovers?",
    "rung": r"(?<!has\s)rungs?",
    "null": "nulls",
}
"""By anchor of the glossary how its private words stand in a sentence. A page links each of them where it first stands;
words that mean what they mean elsewhere (run, line, effect, class) are looked up by who doubts them."""

_NO_SENTENCE = re.compile(
    r"^#.*$|^ {4}.*$|^\|.*$|`[^`]*`|^<!--.*$|"  # headings, formulas, tables, code, marks of what a program writes
    r"!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\([^)\s]+\)",  # links with their text
    re.MULTILINE,
)
"""What is no part of a sentence."""


def first_words(page: Path) -> dict[str, tuple[int, int]]:
    """By anchor of `WORDS` where its word first stands unlinked in a sentence of `page`, as offsets."""

    def blank(found: re.Match[str]) -> str:
        return re.sub(r"[^\n]", " ", found[0])

    text = _NO_SENTENCE.sub(blank, _FENCE.sub(blank, page.read_text(encoding="utf-8")))
    found = {
        anchor: re.search(rf"(?<![\w/-])(?:{words})(?![\w/-])".replace(" ", r"\s+"), text, re.IGNORECASE)
        for anchor, words in WORDS.items()
    }
    return {anchor: one.span() for anchor, one in found.items() if one is not None}


def headings(page: Path) -> tuple[str, ...]:
    """The headings of `page` without their marks."""
    return tuple(found.strip() for found in re.findall(r"^#+ +(.+)$", prose(page), re.MULTILINE))


def anchors(page: Path) -> frozenset[str]:
    """What may stand behind ``#`` in a link to `page`."""
    return frozenset(anchors_of(headings(page)))


def anchors_of(names: Iterable[str]) -> tuple[str, ...]:
    """An anchor for each of the headings, in order; one that came before gets a number: ``name-1``."""
    seen: dict[str, int] = {}
    made = []
    for name in map(anchor, names):
        count = seen.setdefault(name, 0)
        made.append(f"{name}-{count}" if count else name)
        seen[name] += 1
    return tuple(made)


def anchor(heading: str) -> str:
    """The anchor of a heading, made as GitHub makes it: small letters, blanks as hyphens, no other signs."""
    return re.sub(r"[^\w\- ]", "", heading.replace("`", "").lower()).replace(" ", "-")


def title(page: Path) -> str:
    """The first heading of `page`."""
    return headings(page)[0]


def said_about(path: Path) -> str:
    """The words that a PNG was written with; empty without any."""
    from PIL import Image

    from validation.report.charts.static import ABOUT

    with Image.open(path) as picture:
        return str(picture.info.get(ABOUT, ""))
