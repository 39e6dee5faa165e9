"""`python -m sim_node`."""

from __future__ import annotations

import sys

from sim_node.app import main

sys.exit(main())
