"""How much longer a solve takes from Python than inside the library.

Both are measured in this process, in turns: `Solver.distance`, and the solve that `run` times. The
shortest times are compared, which a busy machine disturbs least. With --strict, exits with 1 if
Python costs more than 5 %.
"""

import argparse
import sys
import time

import geodesics as gd

ALLOWED = 0.05


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", nargs="?", default="gen:torus,faces=70000,bump=0.1")
    parser.add_argument("--algorithm", default="vtp-fast")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--strict", action="store_true")
    options = parser.parse_args()
    generated = options.model.startswith("gen:")
    mesh = gd.generate(options.model) if generated else gd.read(options.model)
    solver = gd.Solver(mesh, options.algorithm)
    solver.distance(0)
    inside, outside = [], []
    for _ in range(options.rounds):
        row = gd.run(options.algorithm, mesh, repeat=5, check="none")[0]
        inside += row["time_samples"]
        for _ in range(5):
            start = time.perf_counter()
            solver.distance(0)
            outside.append(time.perf_counter() - start)
    inside, outside = min(inside), min(outside)
    overhead = outside / inside - 1
    print(
        f"{mesh.name}, {options.algorithm}: {1e3 * inside:.2f} ms in the library, "
        f"{1e3 * outside:.2f} ms from Python: {100 * overhead:+.1f} %"
    )
    return int(options.strict and overhead > ALLOWED)


if __name__ == "__main__":
    sys.exit(main())
