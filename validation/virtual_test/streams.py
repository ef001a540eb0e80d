"""Random streams by name: what is drawn under a name depends on the seed and on the name, and on nothing that was drawn before.

So a laboratory stays the same when another article is mounted, another run is added, or another tolerance is drawn as well.
"""

from __future__ import annotations

from hashlib import blake2b

import numpy as np


def stream(seed: int, *names: str) -> np.random.Generator:
    """The generator of `names` under `seed`; the same on every machine and in every process."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=_key(names)))


def token(seed: int, *names: str) -> str:
    """Eight characters that belong to `names` under `seed` and show neither."""
    return _digest(f"{seed}", *names).hex()[:8]


def _key(names: tuple[str, ...]) -> tuple[int, ...]:
    """Four words of 32 bits."""
    return tuple(int(word) for word in np.frombuffer(_digest(*names), dtype="<u4"))


def _digest(*words: str) -> bytes:
    return blake2b("\0".join(words).encode(), digest_size=16, person=b"massline").digest()
