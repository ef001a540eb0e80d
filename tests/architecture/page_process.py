"""What a page tells its reader to type, done in one process: no library is imported twice. Steps come as JSON on standard input.

    python page_process.py REPOSITORY ANSWER

A step is a command line (`words`), a program (`python`), or a file that is written (`file`, `text`, `append`). The answer is a
JSON list of exit code and printed text, a step each; it ends at the first step that ends otherwise than it should (`ends`).
"""

import io
import json
import os
import runpy
import signal
import subprocess
import sys
import traceback
import warnings
from contextlib import redirect_stderr, redirect_stdout
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit


def main(repository: Path, answer: Path) -> None:
    warnings.simplefilter("ignore", RuntimeWarning)  # as the console script does
    namespace: dict[str, Any] = {"__name__": "__page__"}
    answers = []
    for step in json.load(sys.stdin):
        printed = io.StringIO()
        with redirect_stdout(printed), redirect_stderr(printed):
            code = done(step, repository, namespace)
        answers.append({"code": code, "printed": printed.getvalue()})
        if code != step["ends"]:
            break
    answer.write_text(json.dumps(answers), encoding="utf-8")


def done(step: dict[str, Any], repository: Path, namespace: dict[str, Any]) -> int:
    """Exit code of one step."""
    if "file" in step:
        path = Path(step["file"])
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text((path.read_text(encoding="utf-8") if step["append"] else "") + step["text"], encoding="utf-8")
        return 0
    try:
        if "python" in step:
            exec(compile(step["python"], step["of"], "exec"), namespace)
            return 0
        program, *arguments = step["words"]
        return massline(arguments) if program == "massline" else script(repository / arguments[0], arguments[1:])
    except Exception:
        traceback.print_exc()
        return -1


def massline(arguments: list[str]) -> int:
    from validation.cli.main import run

    return workbench(arguments) if arguments[0] == "app" and "--help" not in arguments else run(arguments)


def workbench(arguments: list[str]) -> int:
    """Begin to serve, be let in at the address that is printed, end by Ctrl-C: 0 when all of it went well."""
    entry = [sys.executable, "-P", "-c", "from validation.cli.main import main; main()", *arguments, "--no-browser"]
    with subprocess.Popen(entry, stdout=subprocess.PIPE, text=True, process_group=0) as process:
        assert process.stdout is not None
        address = next((urlsplit(line.strip()) for line in process.stdout if "?token=" in line), None)
        admitted = False
        if address is not None:
            connection = HTTPConnection(str(address.hostname), address.port, timeout=60)
            connection.request("GET", f"{address.path}?{address.query}")
            admitted = connection.getresponse().status < 400
            os.killpg(process.pid, signal.SIGINT)
        code = process.wait(timeout=60)
    return 0 if admitted and code in (0, 130) else code or -1


def script(path: Path, arguments: list[str]) -> int:
    """Run a script of the repository as Python does: its own folder first on the path, its own arguments."""
    before, sys.argv = sys.argv, [str(path), *arguments]
    sys.path.insert(0, str(path.parent))
    try:
        runpy.run_path(str(path), run_name="__main__")
    except SystemExit as left:
        return left.code if isinstance(left.code, int) else int(left.code is not None)
    finally:
        sys.path.remove(str(path.parent))
        sys.argv = before
    return 0


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
