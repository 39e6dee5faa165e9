"""`python -m hw_node`."""

from __future__ import annotations

import sys

from hw_node.app import main

sys.exit(main())
