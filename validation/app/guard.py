"""What a request must be before anything answers it: to this host, from this page, by somebody who was let in.

- **Host.** A foreign name that was made to resolve to 127.0.0.1 (DNS rebinding) still says its own name here, and is refused.
- **Origin.** A page of another site may send requests and open websockets to this machine, and a browser says from where.
  Whatever changes something, and every websocket, must say that it comes from here.
- **Session.** The cookie of `entry`.
"""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from typing import TYPE_CHECKING

from validation.app.asked import is_loopback

if TYPE_CHECKING:
    from collections.abc import Mapping

READING = ("GET", "HEAD")


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
        if port != str(self.port) or not host:
            return False
        if host.lower() in ("127.0.0.1", "localhost", self.host.lower()):
            return True
        return not is_loopback(self.host) and _is_address(host)


def refused(place: Place, headers: Mapping[str, str], *, method: str, websocket: bool) -> Refusal | None:
    """Why a request with `headers` is not answered whoever sends it; None if it may go on to be asked for its session."""
    host = headers.get("Host", "")
    if not place.answers_to(host):
        return Refusal(status=403, text="this address serves no other host; open the one that the terminal shows.")
    origin = headers.get("Origin")
    if origin is None:
        if websocket or method not in READING:
            return Refusal(status=403, text="a request that changes something must say which page sends it.")
    elif origin.lower() != f"http://{host.lower()}":
        return Refusal(status=403, text="a page of another origin may not ask this one.")
    return None


NO_SESSION = Refusal(
    status=401,
    text="this page opens with the address that the terminal shows, once, and in one browser. "
    "If that address has been used, start `massline app` again.",
)


def _is_address(host: str) -> bool:
    """Whether `host` is a numeric address: those no name server can bend."""
    try:
        ip_address(host.strip("[]"))
    except ValueError:
        return False
    return True
