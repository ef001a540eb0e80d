"""Progress on standard error for work over a second: what is being done now, silent where nobody watches."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager


@contextmanager
def shown(words: str, *, quiet: bool = False) -> Iterator[None]:
    """Show `words` with a spinner while the block runs, if standard error is a terminal and not `quiet`."""
    if quiet or not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(words):
        yield


def counted(items: Iterable[str], words: str, *, quiet: bool = False) -> Iterator[str]:
    """`items` one after the other, each announced as ``words: item (2 of 5)`` while the caller works on it."""
    listed = list(items)
    for number, item in enumerate(listed, start=1):
        with shown(f"{words}: {item} ({number} of {len(listed)})", quiet=quiet):
            yield item


@contextmanager
def percent(words: str, *, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show `words` with the share done while the block runs, as `shown` does; it is told by calling what the block is given."""
    if quiet or not sys.stderr.isatty():
        yield lambda share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda share: status.update(f"{words}: {100 * min(max(share, 0.0), 1.0):.0f} %")


@contextmanager
def stages(words: str, *, quiet: bool = False) -> Iterator[Callable[[str, float], None]]:
    """The same for work of several stages: what the block is given hears the name of the stage and the share of it."""
    if quiet or not sys.stderr.isatty():
        yield lambda stage, share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda stage, share: status.update(f"{words}: {stage} {100 * min(max(share, 0.0), 1.0):.0f} %")
