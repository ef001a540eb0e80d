"""Nothing in the repository names this machine, a registry's host, or a time that was true once."""

import re
import shutil
import subprocess
from pathlib import Path

FORBIDDEN = {
    "a machine path": re.compile(r"(?<![\w.~<>])/(?:home|root|tmp|work|Users|opt|mnt|farm)/[A-Za-z0-9_.-]+"),
    "a package registry": re.compile(
        r"https?://[^\s\"')>]*(?:pypi|pythonhosted|simple/|registry|mirror|/debian)[^\s\"')>]*", re.IGNORECASE
    ),
    "unfinished work": re.compile(r"\b(?:TODO|FIXME|XXX)\b"),
}

THIS = Path(__file__).name


def tracked(root: Path) -> list[Path]:
    """Files of the repository that git would take, committed or not; without git every file outside the ignored folders."""
    if shutil.which("git"):
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listed = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
        if listed.returncode == 0:
            return [path for name in listed.stdout.split("\0") if name and (path := root / name).is_file()]
    lines = (root / ".gitignore").read_text(encoding="utf-8").splitlines()
    ignored = {".git", *(line.rstrip("/") for line in lines if line.endswith("/"))}
    return [path for path in root.rglob("*") if path.is_file() and not ignored & set(path.relative_to(root).parts)]


def test_no_tracked_file_names_a_machine_a_registry_or_unfinished_work(root: Path) -> None:
    assert len(tracked(root)) > 50
    found = [
        f"{path.relative_to(root)}:{number}: {what}: {hit.group()}"
        for path in tracked(root)
        if path.name != THIS and b"\0" not in path.read_bytes()  # the bytes of a picture may spell anything
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="ignore").splitlines(), start=1)
        for what, pattern in FORBIDDEN.items()
        if (hit := pattern.search(line))
    ]
    assert found == []


def test_the_search_finds_what_it_looks_for() -> None:
    samples = {
        "a machine path": "cd /home/somebody/massline",
        "a package registry": "--index-url https://pypi.example.org/simple",
        "unfinished work": "# TODO: later",
    }
    assert all(FORBIDDEN[what].search(sample) for what, sample in samples.items())


def test_every_locked_package_has_one_version_and_a_hash(root: Path) -> None:
    lock = (root / "requirements.lock").read_text(encoding="utf-8")
    entries = re.split(r"\n(?=\S)", lock.strip())
    assert len(entries) > 50
    assert [entry for entry in entries if not re.match(r"[a-z0-9._-]+==\S+.*\\\n\s+--hash=sha256:[0-9a-f]{64}", entry)] == []
