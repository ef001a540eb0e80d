"""What the files of a folder are called that a diagnosis is handed."""

from typing import Any

MODEL = "model.toml"
"""What the laboratory knows beforehand."""

SETTINGS = "settings.json"
"""Which campaigns there are, which sweeps to hold out, which families to do without."""

ANSWER = "answer.json"
"""What the diagnosis says."""

Json = dict[str, Any]
