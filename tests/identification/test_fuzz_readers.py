"""Every reader on 200 damaged files: a sentence or the truth, and never a hang, a crash, a traceback or a silently wrong value.

`python -m benchmarks.fuzz_readers` runs 10,000 a reader.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import fuzz_readers
from benchmarks.fuzz_readers import TARGETS, Target
from identification.campaign_file import recording
from identification.files.files import Signals

COUNT = 200


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_a_damaged_signal_file_is_refused_or_read_as_it_was(
    target: Target, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    counts = fuzz_readers.run(target, COUNT, tmp_path)
    assert sum(counts.values()) == COUNT
    assert [what for what in counts if what.startswith("FAILED")] == []
    assert counts["refused"] > COUNT / 4  # the damage is real
    assert capfd.readouterr() == ("", "")


def test_a_damaged_description_is_refused_or_read_as_it_was(capfd: pytest.CaptureFixture[str]) -> None:
    counts = fuzz_readers.run_toml(COUNT)
    assert [what for what in counts if what.startswith("FAILED")] == []
    assert counts["refused"] > COUNT / 2
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("read", "verdict"),
    [
        (lambda signals: signals, "read"),
        (lambda signals: changed(signals, 1), "digits"),
        (lambda signals: changed(signals, 2), "FAILED: 2 values changed"),
        (lambda signals: 1 / 0, "FAILED: ZeroDivisionError"),
        (lambda signals: time.sleep(3), "FAILED: hangs"),
    ],
)
def test_the_judge_sees_a_reader_that_believes_too_much(
    read: Callable[[Signals], Signals], verdict: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    channels, target = fuzz_readers.table(), TARGETS[0]
    signals = fuzz_readers.signals(channels.names, spectra=False)
    whole, _ = recording(signals, channels, "campaign.toml")
    assert whole is not None
    monkeypatch.setattr(fuzz_readers, "PATIENCE", 1)
    monkeypatch.setattr(fuzz_readers.files, "read", lambda path: read(signals))
    one = fuzz_readers.Mutant(content=b"", replaced=1)
    assert fuzz_readers.judged(target, whole, channels, tmp_path / "x.csv", one).startswith(verdict)


def changed(signals: Signals, count: int) -> Signals:
    """`signals` with so many of its numbers changed."""
    samples = dict(signals.samples)
    name = next(iter(samples))
    samples[name] = samples[name] + (np.arange(len(samples[name])) < count)
    return replace(signals, samples=samples)
