"""Long calls release the lock of the interpreter and end on Ctrl-C."""

import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import geodesics as gd

CALLS = {
    "distance": "mesh.distance(0)",
    "distances": "mesh.distances(range(400))",
    "solver": "solver.distance(0)",
    "paths": "mesh.paths(0, range(mesh.n_vertices))",
    "voronoi": "mesh.voronoi(range(0, 90000, 3))",
    "isolines": "mesh.isolines(0, every=0.1)",
    "certify": "gd.certify(mesh, 0)",
    "generate": "gd.generate('torus,faces=4000000')",
    "Mesh": "gd.Mesh(large.vertices, large.faces)",
    "run": "gd.run(['mmp', 'vtp'], [mesh], repeat=10_000)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="no signals between processes")
@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_a_call(name):
    """The calls take seconds to hours. Each ends within a second of the signal, on a busy machine
    within a minute."""
    program = f"""
        import signal
        import geodesics as gd
        # A shell lets programs that it starts in the background ignore Ctrl-C.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        mesh = gd.generate("terrain,n=300,seed=1")
        solver = gd.Solver(mesh, "mmp") if {name!r} == "solver" else None
        large = gd.generate("torus,faces=1000000") if {name!r} == "Mesh" else None
        print("ready", flush=True)
        try:
            while True:
                {CALLS[name]}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            assert mesh.distance(0, radius=1e-3)[0] == 0
        """
    child = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.3)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "interrupted\n"
        assert time.monotonic() - sent < 60
        assert child.wait(600) == 0
    finally:
        child.kill()
        child.wait()


def test_other_threads_run_during_a_call():
    """If calls kept the lock, there would be a beat at each end of a call at most."""
    mesh = gd.generate("terrain,n=250,seed=1")
    solver = gd.Solver(mesh, "mmp")
    beats, done = [], threading.Event()

    def beat():
        while not done.is_set():
            beats.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=beat)
    thread.start()
    try:
        # A busy machine may give the other thread few turns during a call.
        for _ in range(100):
            start = time.monotonic()
            solver.distance(0)
            end = time.monotonic()
            during = [b for b in beats if start < b < end]
            gaps = [b - a for a, b in zip(during, during[1:])]
            if len(during) > 5 and max(gaps) < (end - start) / 2:
                break
        else:
            pytest.fail(f"{len(during)} beats in {end - start} s, with gaps of {gaps}")
    finally:
        done.set()
        thread.join()
