"""How many threads the linear algebra of the command takes: one, or as many as the user asks for."""

import os

import pytest

import massline_command


@pytest.mark.parametrize(("asked", "taken"), [(None, "1"), ("3", "3")])
def test_the_command_takes_one_thread_and_no_other_than_was_asked_for(monkeypatch, capfd, asked, taken):
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if asked is not None:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", asked)
    monkeypatch.setattr("sys.argv", ["massline", "--version"])
    with pytest.raises(SystemExit) as ended:
        massline_command.main()
    assert ended.value.code == 0
    assert "massline" in capfd.readouterr().out
    assert os.environ["OPENBLAS_NUM_THREADS"] == taken
