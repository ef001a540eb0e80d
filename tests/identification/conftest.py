"""What tests of campaigns ask for: the campaign of the example, whole and as a folder of its own."""

import runpy
from collections.abc import Callable
from pathlib import Path

import pytest

from identification import campaign_file
from identification.campaign import Campaign

Folder = Callable[..., Path]


@pytest.fixture(scope="session")
def campaign(root: Path) -> Campaign:
    """A rigid block on a table, six short sweeps and the paper's 22 signals."""
    made: Campaign = runpy.run_path(str(root / "examples" / "own_campaign.py"))["campaign"]()
    return made


@pytest.fixture
def folder(campaign: Campaign, tmp_path: Path) -> Path:
    """The campaign in a folder that a test may spoil."""
    campaign_file.write(tmp_path / "campaign", campaign)
    return tmp_path / "campaign"
