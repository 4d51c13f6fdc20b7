"""Runs the program: `python -m biela`."""

import sys

from . import main

sys.exit(main())
