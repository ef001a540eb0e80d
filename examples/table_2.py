"""Table 2 of the paper as an inverse problem: what would a laboratory have to have wrong to read these seven deviations?

    python examples/table_2.py [--out DIR] [--records]

A virtual test of the reconstructed one-blade Clumod is read as the paper reads its records. Every effect of the catalogue, every
pair and the best triples are weighed against tolerances alone; then a menu of measurements, for what each would have decided.
With --records two explanations are simulated in time as well. docs/table-2.md tells it; what it is told with stands beside it, in
``table_2_parts``.
"""

from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console
from table_2_parts import pictures, tables
from table_2_parts.story import Story, told

from validation.output import shown


def tell(console: Console, *, records: bool = False) -> Story:
    """Tell it, and return what was found."""
    with shown("weighing explanations"):
        story = told(records=records)
    for section in tables.told(story):
        console.print(section, markup=False, highlight=False, soft_wrap=True)
    return story


@click.command()
@click.option("--out", default="out/table-2", type=click.Path(path_type=Path), show_default=True)
@click.option("--records/--no-records", default=False, help="Simulate two explanations in time as well.")
def main(out: Path, records: bool) -> None:
    """Tell what may have been behind Table 2."""
    console = Console()
    story = tell(console, records=records)
    console.print(f"Drawn: {', '.join(str(path) for path in pictures.draw(story, out))}")


if __name__ == "__main__":
    main()
