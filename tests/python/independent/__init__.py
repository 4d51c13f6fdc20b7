"""Kinematics of mechanism files in sixty digits.

It reads the files and follows docs/file-format.md and docs/constraints.md, and shares no code with
biela.
"""

from .motion import Pose
from .rounding import Rounding

__all__ = ["Pose", "Rounding"]
