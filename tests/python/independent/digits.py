"""Arithmetic of sixty digits, real and complex, apart from the digits that other tests choose."""

from __future__ import annotations

from functools import cache

from mpmath import MPContext

mp = MPContext()
mp.dps = 60

number = cache(mp.mpf)
"""Decimal text as the number that it says, without the rounding to binary doubles."""


def whole_turns(angle):
    """Returns the whole turns nearest to an angle [rad], by its real part."""
    return 2 * mp.pi * mp.nint(angle.real / (2 * mp.pi))
