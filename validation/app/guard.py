"""What a request must be before anything answers it: to this host, from this page, by somebody who was let in.

- **Host.** A foreign name that was made to resolve to 127.0.0.1 (DNS rebinding) still says its own name here, and is refused.
- **Origin.** A page of another site may send requests and open websockets to this machine, and a browser says from where.
  Whatever changes something, and every websocket, must say that it comes from here.
- **Site.** A page of another server on this machine is of the same site, since cookies and sites know no ports. Browsers that say
  where a request comes from (``Sec-Fetch-Site``) must say: this page, or the user. Only the token may come from anywhere.
- **Session.** The cookie of `entry`. The browser sends it to every server at this host, whatever its port: a program that serves
  pages on this machine and is not to be trusted could take it over. Nothing but a name for every door would help against that.
"""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from typing import TYPE_CHECKING

from validation.app.asked import is_loopback

if TYPE_CHECKING:
    from collections.abc import Mapping

READING = ("GET", "HEAD")

HTTP = 80
"""The port that an address need not name."""


@dataclass(frozen=True, kw_only=True)
class Refusal:
    """Why a request is not answered, as a status of HTTP and a sentence."""

    status: int
    text: str


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where the door stands: the address it listens on, and its port."""

    host: str
    port: int

    def answers_to(self, name: str) -> bool:
        """Whether `name`, a Host header, means this door and cannot have come from a foreign name."""
        host, _, port = name.rpartition(":")
        if not host and self.port == HTTP:  # a browser leaves it out
            host, port = name, str(HTTP)
        if port != str(self.port) or not host:
            return False
        host = host.strip("[]")
        if host.lower() in ("127.0.0.1", "::1", "localhost", self.host.lower()):
            return True
        return not is_loopback(self.host) and _is_address(host)


def refused(place: Place, headers: Mapping[str, str], *, method: str, websocket: bool, entering: bool = False) -> Refusal | None:
    """Why a request with `headers` is not answered whoever sends it; None if it may go on to be asked for its session.

    `entering` is one that brings the token.
    """
    host = headers.get("Host", "")
    if not place.answers_to(host):
        return Refusal(status=403, text="this address serves no other host; open the one that the terminal shows.")
    origin = headers.get("Origin")
    if origin is None:
        if websocket or method not in READING:
            return Refusal(status=403, text="a request that changes something must say which page sends it.")
    elif origin.lower() != f"http://{host.lower()}":
        return Refusal(status=403, text="a page of another origin may not ask this one.")
    if not entering and headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin"):
        return Refusal(status=403, text="a page of another server may not ask this one.")
    return None


NO_SESSION = Refusal(
    status=401,
    text="this page opens with the address that the terminal shows, once, and in one browser. "
    "If that address has been used, start `massline app` again.",
)


def _is_address(host: str) -> bool:
    """Whether `host` is a numeric address: those no name server can bend."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True
