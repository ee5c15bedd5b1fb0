"""The Python package: what it says, what it refuses, and what runs leave behind."""

import copy
import os
import pathlib
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import cotree

ROOT = pathlib.Path(__file__).resolve().parents[2]
SYSTEMS = ROOT / "systems"
ARM = """cotree: 1
gravity: [0, -9.81, 0]
parameters: {m: 1, l: 1, I: m*l^2/12}
inputs:
  tau: {value: 0, unit: N*m}
bodies:
  link: {mass: m, com: [l/2, 0, 0], inertia: I, points: {tip: [l, 0, 0]}}
joints:
  pivot: {type: revolute, from: ground, to: link, effort: tau, initial: {q: 1}}
outputs: [pivot.q, link.tip.position.x]
simulation: {duration: 1, samples: 11}
"""


@pytest.fixture(scope="module")
def arm():
    return cotree.loads(ARM, name="arm.yaml")


def test_names_and_items(arm):
    assert arm.parameters == ("m", "l", "I")
    assert arm.inputs == ("tau",) and arm.coordinates == ("pivot.q",)
    assert arm.item("tau").unit == "N*m" and arm.item("tau").line == 5
    assert arm.item("pivot.q").kind == "output"  # outputs first
    assert arm.item("pivot.q", kind="coordinate").value == 1
    with pytest.raises(KeyError):
        arm.item("nothing")
    with pytest.raises(ValueError):
        arm.item("pivot.q", kind="place")


def test_errors_have_places():
    with pytest.raises(cotree.Error) as caught:
        cotree.loads("cotree: 1\nbodies:\n  a: {mass: -1}\n", name="a.yaml")
    d = caught.value.diagnostics[0]
    assert d.file == "a.yaml" and d.line == 3 and d.code.startswith("E") and "mass" in d.message
    with pytest.raises(cotree.Error):
        cotree.load("/nowhere/at/all.yaml")


def test_a_run_has_columns_and_a_summary(arm):
    r = arm.simulate(until=2, tolerance=1e-9, samples=21)
    assert r.columns == ("t", "pivot.q", "link.tip.position.x")
    assert len(r.t) == 21 and r.t[-1] == 2
    assert np.allclose(np.cos(r["pivot.q"]), r["link.tip.position.x"])
    assert r.summary["model"] == arm.name
    assert r._repr_svg_().startswith("<svg")
    with pytest.raises(KeyError):
        r["nothing"]
    with pytest.raises(cotree.Error):
        arm.simulate(method="euler")


def test_steps_lead_where_runs_lead(arm):
    r = arm.simulate(until=1, tolerance=1e-9)
    d = arm.data(tolerance=1e-9)
    for _ in range(100):
        d.step(0.01)
    assert abs(d.q[0] - r["pivot.q"][-1]) < 1e-7
    with pytest.raises(cotree.Error):
        d.step(-1)


def test_a_state_is_set_and_asked(arm):
    d = arm.data()
    assert d.t == 0 and d.q.shape == (1,) and d.M.shape == (1, 1) and d.J.shape == (0, 1)
    d.inputs["tau"] = 2
    d.q, d.u, d.t = [0.5], [0.1], 3
    assert d.t == 3 and d.q[0] == 0.5 and d.coordinates["pivot.q"] == 0.5
    assert np.allclose(d.M @ d.acceleration, d.Q)
    R, p = d.pose("link.tip")
    assert np.allclose(p, [np.cos(0.5), np.sin(0.5), 0]) and np.allclose(R @ [1, 0, 0], p)
    assert np.allclose(d.inverse(d.acceleration), 0)
    d.parameters["m"] = 2
    assert d.parameters["I"] == pytest.approx(1 / 6)
    other = d.clone()
    d.step(0.1)
    other.step(0.1)
    assert other.q[0] == d.q[0]
    d.reset()
    assert d.t == 0 and d.q[0] == 1 and d.inputs["tau"] == 2
    with pytest.raises(KeyError):
        d.inputs["taw"] = 1
    with pytest.raises(TypeError):
        d.outputs["pivot.q"] = 1
    with pytest.raises(ValueError):
        d.q[0] = 1  # a copy that cannot be written to
    with pytest.raises(cotree.Error):
        d.q = [1, 2]


def test_loops():
    d = cotree.load(SYSTEMS / "four_bar" / "model.yaml").data()
    d.step(0.01)
    residual = d.M @ d.acceleration - d.Q - d.J.T @ d.multipliers
    assert np.max(np.abs(residual)) < 1e-9
    assert np.max(np.abs(d.phi)) < 1e-10
    q = d.q.copy()
    q[0] += 0.05
    d.q = q
    assert np.max(np.abs(d.phi)) > 1e-4
    d.assemble()
    assert np.max(np.abs(d.phi)) < 1e-12


def test_sweeps_by_grids_and_by_lists_agree():
    m = cotree.load(SYSTEMS / "double_pendulum" / "model.yaml")
    grid = m.sweep({"m1": np.linspace(0.5, 1.5, 3)}, until=0.5, tolerance=1e-9)
    assert grid.failed == 0 and list(grid["m1"]) == [0.5, 1, 1.5]
    some = m.sweep({"m1": [0.5, 0.7, 1.5]}, until=0.5, tolerance=1e-9)
    for name in m.outputs:
        assert np.allclose(grid[name][[0, 2]], some[name][[0, 2]], rtol=1e-6, atol=1e-7)
    with pytest.raises(KeyError):
        m.sweep({"nothing": [1]})


INPUTS = """
cotree: 1
parameters: {m: 1}
inputs: {F: {value: 0, unit: N}}
bodies: {b: {mass: m}}
joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: F}}
outputs: [j.q]
"""


def test_sweeps_vary_inputs_of_the_model():
    m = cotree.loads(INPUTS)
    s = m.sweep({"m": [1, 2], "F": [0, 4]}, until=1)
    assert s.columns == ("m", "F", "j.q") and np.allclose(s["j.q"], [0, 2, 0, 1])


def test_frames_need_pandas_and_say_so():
    try:
        import pandas  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="needs pandas"):
            cotree.load(SYSTEMS / "double_pendulum" / "model.yaml").simulate(until=0.1).to_pandas()
    else:
        pytest.skip("pandas is installed")


def test_sweeps_take_what_runs_do_between_samples():
    text = """
cotree: 1
parameters: {k: 1}
bodies: {b: {mass: 1}}
joints: {j: {type: prismatic, axis: x, from: ground, to: b, effort: -k*j.q, initial: {q: 1}}}
outputs: [j.q]
"""
    m = cotree.loads(text)
    k = np.array([1, 4, 25.0])
    s = m.sweep({"k": k}, until=3.3, take={"peak": "max(abs(j.u))", "t1": "time(j.u)",
                                           "never": "time(j.q - 2)", "square": "rms(j.q)"})
    assert s.columns == ("k", "j.q", "peak", "t1", "never", "square") and s.failed == 0
    assert np.allclose(s["peak"], np.sqrt(k), rtol=1e-6)
    t1 = np.pi / np.sqrt(k)
    assert np.allclose(s["t1"], t1, rtol=1e-6)
    assert np.all(np.isnan(s["never"]))
    w = np.sqrt(k)
    assert np.allclose(s["square"]**2, 0.5 + np.sin(2 * w * 3.3) / (4 * w * 3.3), rtol=1e-6)
    with pytest.raises(cotree.Error, match="there is no function 'most'"):
        m.sweep({"k": k}, until=1, take={"peak": "most(j.q)"})


def test_analyses(arm):
    lin = arm.linearize(about="equilibrium")
    assert lin.inputs == ("tau",) and lin.A.shape == (2, 2) and lin.B.shape == (2, 1)
    assert lin.B[1, 0] == pytest.approx(3)
    assert arm.modes(about="equilibrium").omega[0] == pytest.approx(np.sqrt(1.5 * 9.81))
    rest = arm.equilibrium()
    assert rest.is_stable and rest["pivot.q"] == pytest.approx(-np.pi / 2)


def test_texts(arm):
    assert "pivot.q''" in arm.equations(show="reduced")
    assert arm.equations(format="latex") == arm.equations(format="latex")
    assert "digraph" in arm.graph("dot") or "graph" in arm.graph("dot")
    assert "align*" in arm._repr_latex_() and "srcdoc" in arm._repr_html_()
    with pytest.raises(cotree.Error):
        arm.equations(format="png")


def test_threads_share_a_system(arm):
    want = arm.simulate()["pivot.q"]
    got = []

    def run():
        got.append(arm.simulate()["pivot.q"])

    threads = [threading.Thread(target=run) for _ in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(got) == 4 and all(np.array_equal(g, want) for g in got)


def test_ctrl_c_ends_a_run(arm):
    began = []

    def interrupt():
        time.sleep(0.3)
        began.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        arm.simulate(until=1e6, samples=2)
    late = time.perf_counter() - began[0]
    thread.join()
    assert late < 1  # 0.1 s on a quiet machine
    assert arm.simulate().t[-1] == 1


def test_sweeps_work_after_a_fork():
    import multiprocessing
    m = cotree.load(SYSTEMS / "double_pendulum" / "model.yaml")
    values = {"m1": np.linspace(0.5, 1, 4)}
    want = m.sweep(values, until=0.1, threads=2)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        got = pool.apply_async(_sweep_in_child, (values,)).get(60)
    assert np.array_equal(got, want.values)


def _sweep_in_child(values):
    m = cotree.load(SYSTEMS / "double_pendulum" / "model.yaml")
    return m.sweep(values, until=0.1, threads=2).values


CONTROLLED = """cotree: 1
inputs: {goal: {value: 1, unit: m}}
states:
  integral: {rate: goal - slide.q, unit: m*s}
  force: {rate: (40*(goal - slide.q) + 30*integral - 8*slide.u - force)/0.05, initial: 2, unit: N}
bodies: {block: {mass: 2}}
joints: {slide: {type: prismatic, from: ground, to: block, effort: force}}
outputs: [slide.q, force, goal]
"""


def test_states_of_the_model():
    m = cotree.loads(CONTROLLED)
    assert m.states == ("integral", "force") and m.speeds == ("slide.u",)
    assert m.item("integral", kind="state").unit == "m*s"
    assert m.item("force").unit == "N" and m.item("goal").unit == "m"
    d = m.data(tolerance=1e-10)
    assert d.M.shape == (1, 1) and d.z.tolist() == [0, 2]
    assert np.allclose(d.z_rate, [1, (40 - 2) / 0.05])
    d.states["force"] = 3
    d.inputs["goal"] = 0.5
    assert np.allclose(d.z_rate, [0.5, (20 - 3) / 0.05]) and d.acceleration[0] == 1.5
    d.step(0.3)
    twin = m.data(tolerance=1e-10)
    twin.z = [0, 3]
    twin.inputs["goal"] = 0.5
    for _ in range(30):
        twin.step(0.01)
    assert np.allclose(np.hstack([d.q, d.u, d.z]), np.hstack([twin.q, twin.u, twin.z]), rtol=1e-8)
    assert d.clone().z.tolist() == d.z.tolist()
    d.reset()
    assert d.z.tolist() == [0, 2]
    lin = m.linearize()
    assert lin.states == ("slide.q", "integral", "force", "slide.u") and lin.inputs == ("goal",)
    poles = sorted(np.linalg.eigvals(lin.A).real)
    assert poles[-1] < 0 and m.equilibrium()["slide.q"] == pytest.approx(1)


def test_inputs_from_a_table(tmp_path):
    m = cotree.loads(CONTROLLED)
    table = {"t": [0, 1, 2], "goal": [0, 2, 1]}
    assert m.simulate(until=2, samples=5, input=table)["goal"].tolist() == [0, 1, 2, 1.5, 1]
    held = m.simulate(until=2, samples=5, input=table, hold=True)
    assert held["goal"].tolist() == [0, 0, 2, 2, 1]
    d = m.data(tolerance=1e-10)
    for goal in (0, 2):
        d.inputs["goal"] = goal
        d.step(1)
    assert held["slide.q"][-1] == pytest.approx(d.q[0], rel=1e-7)
    (tmp_path / "goal.csv").write_text("t [ms],goal [mm]\n0,1000\n2000,500\n")
    assert m.simulate(until=2, samples=2, input=tmp_path / "goal.csv")["goal"].tolist() == [1, 0.5]
    with pytest.raises(cotree.Error) as e:
        m.simulate(until=2, input={"t": [0, 2], "gaol": [1, 1]})
    assert e.value.diagnostics[0].line == 1 and "did you mean 'goal'" in str(e.value)


def test_report_is_one_page_of_the_same_bytes(arm, tmp_path):
    pages = [tmp_path / "a.html", tmp_path / "b.html"]
    try:
        for page in pages:
            arm.report(page, until=0.5)
    except cotree.Error as error:
        assert error.diagnostics[0].code == "E530"  # built without it
        return
    text = pages[0].read_text(encoding="utf-8")
    assert text.startswith("<!DOCTYPE html>") and 'id="manifest"' in text
    assert text == pages[1].read_text(encoding="utf-8")
    with pytest.raises(cotree.Error):
        arm.report(tmp_path / "missing" / "a.html")


def test_systems_are_pickled_by_their_model_and_states_are_not():
    m = cotree.loads(INPUTS, set={"m": 2})
    for other in (pickle.loads(pickle.dumps(m)), copy.copy(m), copy.deepcopy(m)):
        assert other.item("m").value == 2
        d = other.data()
        d.step(0.1)
        del other, d
    with pytest.raises(TypeError, match="pickled"):
        pickle.dumps(m.data())


def test_values_are_assigned_by_dictionaries_and_other_names_refused():
    d = cotree.loads(INPUTS).data()
    d.inputs = {"F": 4}
    assert d.inputs["F"] == 4 and d.acceleration[0] == 4
    with pytest.raises(TypeError):
        d.outputs = {"j.q": 1}
    with pytest.raises(AttributeError):
        d.input = 1


def test_zero_is_no_option_of_a_run():
    m = cotree.loads(INPUTS)
    for name in ("until", "tolerance", "absolute", "step", "samples"):
        with pytest.raises(ValueError, match="%s is 0; it must be greater than 0" % name):
            m.simulate(**{"until": 1, name: 0})
    with pytest.raises(ValueError, match="at least one"):
        m.sweep({})
