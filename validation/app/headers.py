"""What every answer tells the browser: take nothing from elsewhere, guess no types, show this page in no other."""

from __future__ import annotations

SECURITY = {
    # Vue compiles the page's templates in the browser, which needs `unsafe-eval`; nothing that a user's file says is ever part of
    # a template. Styles are set by the widgets themselves.
    "Content-Security-Policy": "; ".join(
        (
            "default-src 'none'",
            "script-src 'self' 'unsafe-eval'",
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' data: blob:",
            "font-src 'self' data:",
            "connect-src 'self'",
            "frame-ancestors 'none'",
            "base-uri 'self'",
            "form-action 'none'",
        )
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}

NEVER_KEPT = {"Cache-Control": "no-store"}

DOOR_SECRET = "X-Massline-Door"
"""What the door says to a window's own server, and nobody else knows."""
