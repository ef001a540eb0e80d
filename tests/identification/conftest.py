"""What tests of campaigns ask for: the campaign of the example, whole and as a folder of its own."""

import runpy
import shutil
from pathlib import Path

import pytest

from identification import campaign_file
from identification.campaign import Campaign


@pytest.fixture(scope="session")
def campaign(root: Path) -> Campaign:
    """A rigid block on a table, six short sweeps and the paper's 22 signals."""
    made: Campaign = runpy.run_path(str(root / "examples" / "own_campaign.py"))["campaign"]()
    return made


@pytest.fixture(scope="session")
def written(campaign: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign in a folder that stays as it is."""
    whole = tmp_path_factory.mktemp("written") / "campaign"
    campaign_file.write(whole, campaign)
    return whole


@pytest.fixture
def folder(written: Path, tmp_path: Path) -> Path:
    """The campaign in a folder that a test may spoil."""
    return Path(shutil.copytree(written, tmp_path / "campaign"))
