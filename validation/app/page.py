"""The page of a window."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from validation.app import shell
from validation.app.asked import Opened


def build(server: Any, folder: Path, opened: Opened) -> None:
    """Lay out the page of `server`."""
    from trame.ui.vuetify3 import VAppLayout
    from trame.widgets import vuetify3 as v3

    server.enable_module({"serve": {shell.SERVED: str(shell.WWW)}})
    state = server.state
    state.trame__title = "massline"
    state.number = 0
    with VAppLayout(server), v3.VMain():
        v3.VTextField(v_model=("number", 0), label="Number", id="number")
