"""docs/effects.md, made of the catalogue of effects and the example of an effect of one's own.

    python -m tools.effects_page [PATH]

in the root of the repository writes it.
"""

import sys
from pathlib import Path

from geometry.atomic import write_text
from validation.effects import effect
from validation.effects.catalogue import FAMILIES, SOURCES
from validation.report import effects
from validation.report.document import Grid, markdown_escaped, pipes

PAGE = Path("docs/effects.md")
OWN = "examples/effects/dashpot.py"

HEAD = """\
# The catalogue of effects

What may be missing in a model, or wrong in a measurement, under one name each. One effect takes part in everything: it is
simulated, compared, added to a model, refitted and shown. This page is made of the code, by
`python -m tools.effects_page`.

```sh
massline effects
massline effects force-gain:fmd-z2 saturation
massline effects gap --json
massline effects force-gian    # exit 2
```

## How to read it

An effect is `family:target`, and `family:target=VALUE` gives its size in SI; several sizes are `key:number,key:number`.
*Tolerance* is what a careful laboratory admits of it anyway, *plausible* what a fault may be, each one standard deviation before
anything was measured; × 7.4 is a factor either way. An effect that is added leaves its tolerance: what is known of it beforehand
widens from the one to the other.

A prediction is made in stages, from the matrices of the structure to what every channel reads. An effect changes one of them, or
opens a parameter that every laboratory has anyway.

Targets are those of what is tested. A part, place, support or joint of the built-in articles has a name of its own; those of a
[structure of your own](own-model.md) are the names that its file gives. `mass` needs the share of each part in the mass,
`thickness` a shell or beam, `support-stiffness` a spring to the ground, `connection-compliance` a joint between two parts
(`joint-compliance` is that of an article on its base), `gravity-stiffness` the geometric stiffness: arrays `geometric/PART` of
another code under 1 g, or `[fe_model.storeys]` between two places with their height. Its size is a factor on gravity: 1
where the weights are right.

"""

TAIL = """\
## An effect of your own

One file, with a `FAMILY`, in a folder that `--effects-from` names; the option may be repeated. A file whose name begins with an
underscore is left alone. An installed package brings effects by entry points of the group `massline.effects`. This is
`{own}`, whole:

```python
{code}```

```sh
massline effects --effects-from examples/effects dashpot force-lowpass
massline simulate fmd+cuboid --out c --octaves-per-minute 99 --effects-from examples/effects --effect force-lowpass:fmd-z2=1e-3
```

The equation is `change(stage, targets, values)` and returns a changed copy, `dataclasses.replace(stage, ...)`. It gets a noun of
`validation/effects/stages.py`, the targets of the identifier, and the sizes by key, the empty key for one that stands alone.
`plant` is what a virtual test simulates, in time and by other code: without one an effect can be fitted, but not simulated.
`python examples/own_effect.py` plants one and finds its size again, with nothing but a model and the campaign.

Before it is taken, massline tries it. At its `null` size it must change nothing; on channels it must be linear in `rows`; what it
adds to matrices may not depend on them, since derivatives pass it unchanged. The folder is never written to, each file is
executed once, and what fails in it is told with its own line and exit code 2:

```sh
massline effects --effects-from examples/nowhere    # exit 2
```
"""


def text(root: Path) -> str:
    """The page; `root` holds the example of an effect of one's own."""
    own = (root / OWN).read_text(encoding="utf-8")
    parts = []
    for side in effect.SIDES:
        families = [family for name, family in FAMILIES.items() if family.side == side and name not in SOURCES]
        lines = tuple(
            (
                f"`{effects.identifier(one)}`",
                markdown_escaped(effects.unit(one)),
                effects.tolerance(one),
                effects.plausible(one),
                markdown_escaped(one.what),
            )
            for one in families
        )
        grid = Grid(header=("effect", "unit", "tolerance", "plausible", "what"), lines=lines, words=True)
        parts.append(f"## {side.capitalize()}\n\n{pipes(grid)}\n\n" + "\n".join(map(_entry, families)))
    return HEAD + "\n".join(parts) + "\n" + TAIL.format(own=OWN, code=own)


def _entry(family: effect.Family) -> str:
    looks = ", ".join(one if " " in one else f"`{one}`" for one in family.mistaken_for)
    written = ", ".join(f"`{one}`" for one in effects.examples(family))
    return f"""\
### `{family.name}`

{markdown_escaped(effects.sentence(family))}

- Equation: `{family.equation}`. It {effects.DOES[family.stage]}.
- Mistaken for {looks}.
- What would confirm it: {markdown_escaped(family.confirmed_by)}.
- Reference: {markdown_escaped(family.reference)}.
- Written {written}.
"""


if __name__ == "__main__":
    write_text(Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE, text(Path()))
