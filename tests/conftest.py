"""One thread for torch in each test process: they share the cores already."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
