"""The ledger: which seeds are for development, which one is for the test, and every look that was taken at a test draw.

    python -m benchmarks.blind.ledger            what it says
    python -m benchmarks.blind.ledger retire     it was tuned on the test draw: that is for development now, the next is drawn
    python -m benchmarks.blind.ledger retire structures     the same of random structures

A look is one code's figures of the test draw, seen by somebody. The draw is blind as long as every look was at figures of the
very code that is scored: whoever changes the code after a look may have learnt from it. The file ``ledger.json`` is committed.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import date
from hashlib import blake2b
from pathlib import Path

from geometry.atomic import write_text

FILE = Path(__file__).with_name("ledger.json")


TEST, STRUCTURES = DRAWS = ("test", "structures")
"""Test draws: of Clumod's series, and of random structures."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Figures of a test draw that somebody saw: its seed, the hash of the code, the day, and how many cases there were."""

    seed: int
    code: str
    day: str
    cases: int


@dataclass(frozen=True, kw_only=True)
class Ledger:
    """What is written there.

    Attributes
    ----------
    development : seeds that may be looked at as often as one likes
    test : seed of the test draw
    structures : seed of the test draw of random structures
    looks : at this test draw and at former ones, the oldest first
    """

    development: tuple[int, ...]
    test: int
    structures: int = 0
    looks: tuple[Look, ...] = ()

    def looked_at(self, seed: int) -> tuple[Look, ...]:
        """The looks at a draw."""
        return tuple(one for one in self.looks if one.seed == seed)

    def blind(self, seed: int, code: str) -> bool:
        """Whether figures of `code` on the draw `seed` are blind ones."""
        return seed not in self.development and all(one.code == code for one in self.looked_at(seed))

    def with_look(self, look: Look) -> Ledger:
        """The ledger after `look`; more cases of the same code are the same look."""
        others = tuple(one for one in self.looks if (one.seed, one.code) != (look.seed, look.code))
        return replace(self, looks=(*others, look))

    def retired(self, which: str = TEST) -> Ledger:
        """The ledger with the next test draw; the present one is for development from now on.

        The next seed follows from the present one, so that nobody can choose it; it is secret only while nobody works it out.
        That of random structures stands before the newest for development, which is one of Clumod's series.

        Parameters
        ----------
        which : of `DRAWS`
        """
        present: int = getattr(self, which)
        following = int.from_bytes(blake2b(f"{present}".encode(), digest_size=4).digest(), "little") % 2**31
        if which == STRUCTURES:
            return replace(self, development=(*self.development[:-1], present, *self.development[-1:]), structures=following)
        return replace(self, development=(*self.development, present), test=following)


def read(file: Path = FILE) -> Ledger:
    """The ledger in `file`."""
    found = json.loads(file.read_text(encoding="utf-8"))
    looks = tuple(Look(**one) for one in found["looks"])
    return Ledger(development=tuple(found["development"]), test=found["test"], structures=found["structures"], looks=looks)


def write(ledger: Ledger, file: Path = FILE) -> None:
    """`ledger` into `file`."""
    looks = [vars(one) for one in ledger.looks]
    content = {"development": list(ledger.development), "test": ledger.test, "structures": ledger.structures, "looks": looks}
    write_text(file, json.dumps(content, indent=2) + "\n")


def look(seed: int, code: str, cases: int, file: Path = FILE) -> Ledger:
    """The ledger, in which it is written that figures of `code` on the draw `seed` are seen today; not of a development draw."""
    ledger = read(file)
    if seed in ledger.development:
        return ledger
    after = ledger.with_look(Look(seed=seed, code=code, day=date.today().isoformat(), cases=cases))
    write(after, file)
    return after


def told(ledger: Ledger) -> str:
    """What the ledger says, in words."""
    looks = len(ledger.looked_at(ledger.test))
    seen = f"looked at with {looks} versions of the code" if looks > 1 else "looked at with one version of the code"
    former = len({one.seed for one in ledger.looks} - {ledger.test})
    return (
        f"test draw {ledger.test}: {seen if looks else 'not looked at yet'}; {len(ledger.development)} draws for development, "
        f"{former} of them were for the test before"
    )


def main(arguments: Sequence[str]) -> int:
    """Tell what the ledger says, after retiring the test draw where that is asked for."""
    from rich.console import Console

    if list(arguments) in (["retire"], ["retire", STRUCTURES]):
        write(read().retired(arguments[-1] if arguments[1:] else TEST))
    elif arguments:
        Console(stderr=True).print("python -m benchmarks.blind.ledger [retire [structures]]")
        return 2
    Console().print(told(read()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
