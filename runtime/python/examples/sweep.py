"""Sweep on Ray: simulates a million double pendulums for two seconds, in chunks, with progress.

    pip install ./runtime/python ray
    python runtime/python/examples/sweep.py                     # all processors of this machine
    python runtime/python/examples/sweep.py --address auto      # a cluster of Ray whose machines have the package

The random initial angles of a chunk depend on its index only, so that results depend neither on the number of
workers nor on their order. A chunk whose worker is lost is computed again.
"""

import argparse
import os
import sys
import time

import numpy as np
import ray

import linkwork

PENDULUM = """
#[mechanism(gravity = -9.81 * y)]
pub struct DoublePendulum {
    #[body(mass = 1, com = -0.5 * y, inertia = rod(1, 1, y))]
    upper: Body,
    #[body(mass = 1, com = -0.5 * y, inertia = rod(1, 1, y))]
    lower: Body,
    #[joint(ground -> upper, about = z)]
    shoulder: Pin,
    #[joint(upper.at(-y) -> lower, about = z)]
    elbow: Pin,
}
"""
STEP, STEPS = 2e-3, 1000


def chunk(number, size, lose=None):
    """Returns the number of pendulums of a chunk whose elbow has rotated over the top, and the largest energy
    error. If `lose` is a path without a file, the worker creates the file and exits, which simulates the loss
    of a worker."""
    if lose is not None and not os.path.exists(lose):
        open(lose, "w").close()
        os._exit(1)
    pendulum = linkwork.compile(PENDULUM)()
    rng = np.random.default_rng([7, number])
    q, v = rng.uniform(-np.pi, np.pi, (size, 2)), np.zeros((size, 2))
    all_q, all_v = pendulum.roll_out(q, v, steps=STEPS, h=STEP, threads=1)
    energy = lambda k: pendulum.kinetic_energy(all_q[:, k], all_v[:, k]) + pendulum.potential_energy(all_q[:, k])
    over = np.abs(all_q[:, :, 1]).max(axis=1) > np.pi
    return int(over.sum()), float(np.abs(energy(-1) - energy(0)).max())


def sweep(rollouts, size, progress=None, lose=None):
    """Computes all chunks on the workers of Ray; returns the number of elbows that went over the top, and the
    largest energy error."""
    # Up to three workers may be lost for a chunk.
    task = ray.remote(max_retries=3)(chunk)
    numbers = range(-(-rollouts // size))
    sizes = [min(size, rollouts - number * size) for number in numbers]
    waiting = [task.remote(number, size, lose if number == 0 else None) for number, size in zip(numbers, sizes)]
    order = {reference: number for number, reference in enumerate(waiting)}
    found = [None] * len(waiting)
    while waiting:
        done, waiting = ray.wait(waiting, num_returns=1)
        for reference in done:
            found[order[reference]] = ray.get(reference)
        if progress is not None:
            progress(len(found) - len(waiting), len(found))
    return sum(over for over, _ in found), max(error for _, error in found)


def bar(done, of):
    """Prints the progress on one line."""
    print(f"\r{'#' * (40 * done // of):40} {done} of {of} chunks", end="", file=sys.stderr, flush=True)


def main():
    """Runs the sweep and prints its results."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--rollouts", type=int, default=1_000_000)
    options.add_argument("--chunk", type=int, default=2000)
    options.add_argument("--address", default=None)
    given = options.parse_args()
    ray.init(address=given.address, log_to_driver=False)
    start = time.perf_counter()
    over, error = sweep(given.rollouts, given.chunk, bar)
    print(file=sys.stderr)
    seconds = time.perf_counter() - start
    print(f"{over} of {given.rollouts} elbows went over the top; energies are off by {error:.1e} J at most")
    print(f"{seconds:.0f} s, {given.rollouts * STEPS / seconds:.3g} steps a second")
    assert error < 0.1


if __name__ == "__main__":
    main()
