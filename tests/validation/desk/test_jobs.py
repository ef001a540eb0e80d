"""Workers: how far they are, how they end, and that nothing is left of those that were ended."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from geometry.errors import BadInput
from validation.app import workers
from validation.app.session import opened
from validation.app.workers import ADD, CANCELLED, COMPARE, DIAGNOSE, DONE, FAILED, RUNNING, Job, Worker

ORPHANED = """
import os, sys
from validation.app import session, workers

if __name__ == "__main__":
    worker = workers.start(session.opened(sys.argv[1]), "compare")
    print(worker.pid, flush=True)
    sys.stdin.read(1)
    os._exit(1)
"""


def is_there(pid: int | None) -> bool:
    """Whether a process runs; one that ended and was not fetched does not."""
    try:
        return f"{Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()[0]}" != "Z"
    except OSError:
        return False


def at_work(worker: Worker) -> Job:
    """Once it does something."""
    until = time.monotonic() + 60
    while (found := worker.job()).what in ("", "starting") and not found.ended and time.monotonic() < until:
        time.sleep(0.02)
    return found


def test_a_worker_tells_its_end(worked):
    assert worked.job.state == DONE
    assert worked.job.share == 1.0
    assert worked.job.error == ""
    assert worked.job.seconds > 0
    assert worked.job.kind == DIAGNOSE
    assert workers.job(worked.desk) == worked.job


def test_cancel_ends_the_process_within_a_second_and_leaves_nothing(bare):
    worker = workers.start(bare, COMPARE)
    assert at_work(worker).state == RUNNING
    began = time.monotonic()
    found = worker.cancel()
    assert time.monotonic() - began < 1.0
    assert not is_there(worker.pid)
    assert found.state == CANCELLED
    assert workers.job(bare) == found
    assert list(bare.folder.rglob(".*")) == []
    assert bare.comparison() is None
    assert worker.cancel() == found


def test_whoever_asks_while_it_is_cancelled_hears_of_no_failure(bare, monkeypatch):
    """A window asks every moment, and cancels in another thread."""
    worker = workers.start(bare, COMPARE)
    at_work(worker)
    heard: list[Job] = []
    monkeypatch.setattr(workers, "swept", lambda of: heard.append(worker.job()))
    assert worker.cancel().state == CANCELLED
    assert [one.state for one in heard] == [RUNNING]


def test_one_job_a_desk_at_a_time_and_a_worker_that_dies_is_an_error_in_words(bare):
    worker = workers.start(bare, COMPARE)
    with pytest.raises(BadInput, match="at work already"):
        workers.start(bare, DIAGNOSE)
    at_work(worker)
    os.kill(worker.pid or 0, signal.SIGKILL)
    found = worker.wait(5)
    assert found.state == FAILED
    assert "signal 9" in found.error
    assert workers.job(bare) == found


def test_what_cannot_be_done_is_told_in_the_words_of_the_verb(bare):
    found = workers.start(bare, DIAGNOSE, candidates=["nonsense"]).wait(60)
    assert found.state == FAILED
    assert "no effect is called 'nonsense'" in found.error
    assert "Traceback" not in found.error


def test_a_worker_ends_with_whoever_started_it(bare, tmp_path):
    script = tmp_path / "start.py"
    script.write_text(ORPHANED)
    with subprocess.Popen([sys.executable, script, bare.folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as one:
        pid = int(one.stdout.readline())
        assert is_there(pid)
        one.stdin.write("x")
        one.stdin.flush()
        one.wait(30)
    until = time.monotonic() + 15
    while is_there(pid) and time.monotonic() < until:
        time.sleep(0.02)
    assert not is_there(pid)
    assert (workers.recovered(opened(bare.folder)) or Job(kind="", asked={})).state == CANCELLED


def test_a_file_that_says_nonsense_is_no_job_and_there_are_no_other_kinds(bare):
    assert workers.job(bare) is None
    bare.job.write_text('{"kind": 1}')
    assert workers.job(bare) is None
    assert workers.recovered(bare) is None
    with pytest.raises(ValueError, match="compare, diagnose"):
        workers.start(bare, "dance")


def test_progress_is_heard(worked):
    assert {"fitting", "maps"} <= set(worked.heard)


def test_a_failure_that_nobody_foresaw_is_told_and_written_down_and_a_damaged_desk_told(bare):
    found = workers.start(bare, ADD).wait(60)  # nobody says which effect
    assert found.state == FAILED
    assert "nobody foresaw" in found.error
    assert "KeyError" in (bare.folder / "job.log").read_text()
    (bare.folder / "desk.json").write_text("{")
    found = workers.start(bare, COMPARE).wait(60)
    assert found.state == FAILED
    assert "desk.json cannot be read" in found.error
