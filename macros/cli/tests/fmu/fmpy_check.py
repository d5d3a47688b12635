"""Validates FMUs by FMPy, simulates them in both modes, and compares the motions."""

import sys

import numpy as np
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu

for path in sys.argv[1:]:
    problems = validate_fmu(path)
    assert not problems, (path, problems)
    options = dict(stop_time=1.0, output_interval=0.02, relative_tolerance=1e-9, record_events=False)
    exchange, steps = (simulate_fmu(path, fmi_type=kind, **options) for kind in ("ModelExchange", "CoSimulation"))
    for name in exchange.dtype.names:
        difference = np.abs(exchange[name] - steps[name]).max()
        assert difference < 1e-4 * (1 + np.abs(steps[name]).max()), (path, name, difference)
