"""A full motion for each shipped mechanism, as a driver's value, rate and acceleration."""

from __future__ import annotations

import numpy as np
from closed_form import CLOSED_FORMS


def full_motion(name, time, duration=1.0):
    """Driver of mechanism `name` at `time`: value, first and second time derivative.

    Smooth to any order, with accelerations that are not zero:

    * a crank makes one turn from its start value, from rest to rest (a cycloid),
    * the pendulum swings once between +60° and -60°,
    * the telescopic side of `tlv` goes from 0.20 m out to 0.60 m and back; the triangle would
      fold at 0.15 m and 0.65 m.

    All three are offset + slope * time + amplitude * sin or cos (2 pi time / duration).
    """
    time = np.asarray(time, dtype=float)
    w = 2 * np.pi / duration
    sine, cosine = np.sin(w * time), np.cos(w * time)

    if name == "pendulum":
        amplitude = np.radians(60)
        return amplitude * cosine, -amplitude * w * sine, -amplitude * w**2 * cosine
    if name == "tlv":
        amplitude = 0.20
        return 0.40 - amplitude * cosine, amplitude * w * sine, amplitude * w**2 * cosine
    return CLOSED_FORMS[name].start + w * time - sine, w * (1 - cosine), w**2 * sine
