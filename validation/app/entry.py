"""Who may come in: a token that is good once, and the cookie that it is exchanged for.

The token stands in the address, so it may end up in a history or over somebody's shoulder; it is spent at its first use. The
cookie that takes its place cannot be read by a script (``HttpOnly``) and is never sent by another site (``SameSite=Strict``).
Cookies know no ports, so its name carries that of the door: two doors do not put each other's windows out.
"""

from __future__ import annotations

from hmac import compare_digest
from secrets import token_urlsafe


class Entry:
    """The one token of a door, and the session that follows from it."""

    def __init__(self) -> None:
        self.token = token_urlsafe(24)
        self._session = token_urlsafe(32)
        self._spent = False

    def exchanged(self, token: str) -> str | None:
        """The session's secret for the token, the first time; None for a wrong one or one that is spent."""
        if self._spent or not same(token, self.token):
            return None
        self._spent = True
        return self._session

    def admits(self, session: str | None) -> bool:
        """Whether `session`, as a cookie brought it, is the one that was given out."""
        return self._spent and session is not None and same(session, self._session)


def cookie_name(port: int) -> str:
    """The name of the cookie of the door at `port`."""
    return f"massline-{port}"


def same(found: str, expected: str) -> bool:
    """Whether two secrets are equal, in a time that does not tell where they differ."""
    return compare_digest(found.encode("utf-8", "replace"), expected.encode())
