"""Equations of motion of multibody systems, from Python.

    import cotree
    m = cotree.load("arm.yaml")
    r = m.simulate(until=5)
    r["pivot.q"]

A System does not change; any number of threads may use it. A Data is one state of it and belongs to one thread
at a time. Numbers are in SI units and radians.
"""

import ctypes
import json
import os
import tempfile
import threading
from itertools import product

import numpy as np

from . import _library as _l
from ._library import CotreeWarning, Diagnostic, Error, lib

__all__ = ["CotreeWarning", "Data", "Diagnostic", "Error", "Item", "Linearization", "Modes",
           "Equilibrium", "Result", "Sweep", "System", "load", "loads", "version"]

_double_p = ctypes.POINTER(ctypes.c_double)
_byref = ctypes.byref
_get, _value, _step_function = lib.ct_data_get, lib.ct_data_value, lib.ct_data_step


def version():
    """The version of the library, as in "0.1.0"."""
    return lib.ct_version().decode()


# ---- calls that take long -------------------------------------------------------------------------


def _interruptible(context, call):
    """call(), in a thread of its own where this one is to hear of Ctrl-C: a run then ends at its next step."""
    if threading.current_thread() is not threading.main_thread():
        return call()
    answer = {}

    def work():
        try:
            answer["value"] = call()
        except BaseException as error:  # is raised again where the caller is
            answer["error"] = error

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.05)
    except BaseException:
        lib.ct_ctx_cancel(context.pointer)
        thread.join()
        raise
    if "error" in answer:
        raise answer["error"]
    return answer["value"]


def _number(value):
    return repr(float(value))


def _settings(set, tree, columns, beam_elements, beam_formulation, keep_all, for_analysis=False,
              input=None, hold=False):
    """Options of a system, and what must live as long as they do."""
    texts = ["%s=%s" % (k, v if isinstance(v, str) else _number(v))
             for k, v in (set or {}).items()]
    array = _l.strings(texts)
    words = {None: 0, "model": 0, "coordinates": 1, "efforts": 2}
    if columns not in words:
        raise ValueError("columns is 'coordinates', 'efforts' or None, not %r" % (columns,))
    options = _l.SystemOptions(set=array, nset=len(texts), tree=_l.encode(tree),
                               keep_all=keep_all, columns=words[columns],
                               for_analysis=for_analysis, beam_elements=beam_elements or 0,
                               beam_formulation=_l.encode(beam_formulation),
                               input=_l.encode(input), hold_input=hold)
    options.size = ctypes.sizeof(options)
    return options, array


def _run_options(until=None, tolerance=None, absolute=None, step=None, samples=None,
                 method=None, verify=False, backend=None, solver=None):
    for name, value in (("until", until), ("tolerance", tolerance), ("absolute", absolute),
                        ("step", step), ("samples", samples)):
        if value is not None and value == 0:  # to the library 0 means the default
            raise ValueError("%s is %s; it must be greater than 0" % (name, value))
    options = _l.SimOptions(method=_l.encode(method), tolerance=tolerance or 0,
                            absolute=absolute or 0, step=step or 0, until=until or 0,
                            samples=samples or 0, verify=verify, backend=_l.encode(backend),
                            solver=_l.encode(solver))
    options.size = ctypes.sizeof(options)
    return options


def load(path, set=None, tree=None, columns=None, beam_elements=None, beam_formulation=None,
         keep_all=False):
    """Read a model file and derive its equations of motion.

    set: values of parameters, numbers or texts with units; tree: "auto", "joints", "absolute" or a file.
    """
    given = dict(set=set, tree=tree, columns=columns, beam_elements=beam_elements,
                 beam_formulation=beam_formulation, keep_all=keep_all)
    return System(os.fspath(path), None, given)


def loads(text, name="model", set=None, tree=None, columns=None, beam_elements=None,
          beam_formulation=None, keep_all=False):
    """The same for the text of a model; `name` stands for the file in messages."""
    given = dict(set=set, tree=tree, columns=columns, beam_elements=beam_elements,
                 beam_formulation=beam_formulation, keep_all=keep_all)
    return System(name, text, given)


class Item:
    """What a name stands for: name, kind, unit, meaning, value (default or start), line, column."""

    def __init__(self, kind, s):
        self.kind = kind
        self.name = s.name.decode()
        self.unit = s.unit.decode() if s.unit is not None else None
        self.meaning = s.meaning.decode() if s.meaning else ""
        self.value = s.value
        self.line = s.line or None
        self.column = s.column or None

    def __repr__(self):
        unit = " " + self.unit if self.unit else ""
        value = "" if self.value != self.value else " = %g%s" % (self.value, unit)
        return "<%s %s%s: %s>" % (self.kind, self.name, value, self.meaning)


class System:
    """A model and its equations of motion, which do not change."""

    def __init__(self, path, text, given):
        self._context = None
        self.pointer = None
        self.path, self._text, self._given = path, text, given
        context = _l.Context()
        options, kept = _settings(**given)
        if text is None:
            self.pointer = _interruptible(context, lambda: lib.ct_system_load(
                context.pointer, _l.encode(path), _byref(options)))
        else:
            data = text.encode()
            self.pointer = _interruptible(context, lambda: lib.ct_system_load_text(
                context.pointer, data, len(data), _l.encode(path), _byref(options)))
        del kept
        if not self.pointer:
            context.fail()
        context.warn(4)
        self.name = lib.ct_system_name(self.pointer).decode()

    def __del__(self):
        if self.pointer:
            lib.ct_system_destroy(self.pointer)
            self.pointer = None

    # A system does not change: a copy is itself. Another process reads the model again.

    def __copy__(self):
        return self

    def __deepcopy__(self, memo):
        return self

    def __reduce__(self):
        return System, (self.path, self._text, self._given)

    def __repr__(self):
        return "<cotree.System %s: %d coordinates, %d speeds, %d constraints>" % (
            self.name, len(self.coordinates), len(self.speeds), len(self.multipliers))

    # -- names --

    def _item(self, kind, i):
        s = _l.ItemStruct()
        if not lib.ct_system_item(self.pointer, _l.KINDS[kind], i, _byref(s)):
            raise IndexError(i)
        return Item(kind, s)

    def _names(self, kind):
        kept = self.__dict__.setdefault("_names_of", {})
        if kind not in kept:
            if kind == "output":
                n = lib.ct_system_column_count(self.pointer)
                kept[kind] = tuple(lib.ct_system_column(self.pointer, i).decode()
                                   for i in range(n))
            else:
                n = lib.ct_system_count(self.pointer, _l.KINDS[kind])
                kept[kind] = tuple(self._item(kind, i).name for i in range(n))
        return kept[kind]

    parameters = property(lambda self: self._names("parameter"))
    inputs = property(lambda self: self._names("input"))
    coordinates = property(lambda self: self._names("coordinate"))
    speeds = property(lambda self: self._names("speed"))
    multipliers = property(lambda self: self._names("multiplier"))
    states = property(lambda self: self._names("state"))
    outputs = property(lambda self: self._names("output"))
    frames = property(lambda self: self._names("frame"))
    components = property(lambda self: self._names("component"))

    def _index(self, kind, name):
        kept = self.__dict__.setdefault("_index_of", {})
        if kind not in kept:
            kept[kind] = {n: i for i, n in enumerate(self._names(kind))}
        try:
            return kept[kind][name]
        except KeyError:
            raise KeyError("there is no %s %r; there are %s" % (
                kind, name, ", ".join(self._names(kind)) or "none")) from None

    def item(self, name, kind=None):
        """Unit, meaning, value and place of a name. A name may be of several kinds: outputs come first."""
        kinds = [kind] if kind else list(_l.KINDS)
        if kind is not None and kind not in _l.KINDS:
            raise ValueError("there is no kind %r; there are %s" % (kind, ", ".join(_l.KINDS)))
        for k in kinds:
            if name in self._names(k):
                return self._item(k, self._index(k, name))
        raise KeyError("the system has no %s %r" % (kind or "item", name))

    # -- runs --

    def _simulate(self, function, options):
        context = _l.Context()
        rows = []
        width = 8 * len(self.outputs)

        def take(_, t, value, n):
            rows.append((t, ctypes.string_at(value, width) if width else b""))
            return True

        callback = _l.ROW(take)
        results = _l.SimResults(row=callback)
        results.size = ctypes.sizeof(results)

        def run():
            sim = lib.ct_sim_create(context.pointer, self.pointer, _byref(options))
            if not sim:
                return None
            try:
                if not function(context.pointer, sim, _byref(results)):
                    return None
                return _l.take_text(lib.ct_sim_summary_json(sim))
            finally:
                lib.ct_sim_destroy(sim)

        summary = _interruptible(context, run)
        if summary is None:
            context.fail()
        context.warn(4)
        t = np.array([row[0] for row in rows])
        values = np.frombuffer(b"".join(row[1] for row in rows)).reshape(len(t), len(self.outputs))
        return Result(self, t, values.copy(), json.loads(summary))

    def simulate(self, until=None, tolerance=None, input=None, hold=False, **options):
        """Integrate to `until` [s]; options: absolute, step, samples, method, verify, backend, solver.

        input: a CSV file that plays inputs, or the same as columns, {"t": [...], "tau": [...]}; linear between rows,
        or with hold=True a row counts from its t on.
        """
        if input is not None:
            return self._with_input(input, hold).simulate(until, tolerance, **options)
        if hold:
            raise ValueError("hold says how the rows of input count, and there is no input")
        return self._simulate(lib.ct_sim_run,
                              _run_options(until=until, tolerance=tolerance, **options))

    def report(self, path, until=None, tolerance=None, input=None, hold=False, **options):
        """The model, its equations and its motion as one HTML page; options as those of `simulate`."""
        if input is not None:
            return self._with_input(input, hold).report(path, until, tolerance, **options)
        if hold:
            raise ValueError("hold says how the rows of input count, and there is no input")
        context = _l.Context()
        o = _l.ReportOptions(path=os.fsencode(path),
                             run=_run_options(until=until, tolerance=tolerance, **options))
        o.size = ctypes.sizeof(o)
        if not _interruptible(context, lambda: lib.ct_system_report(context.pointer, self.pointer,
                                                                    _byref(o))):
            context.fail()
        context.warn()

    def _with_input(self, input, hold):
        """The same system with inputs that a table plays."""
        given = dict(self._given, hold=bool(hold))
        if isinstance(input, (str, os.PathLike)):
            return System(self.path, self._text, dict(given, input=os.fspath(input)))
        names = list(input.keys())
        columns = [np.asarray(input[name], dtype=float).ravel() for name in names]
        if len({c.size for c in columns}) > 1:
            raise ValueError("the columns of input have %s values: they must be as many" % (
                ", ".join(str(c.size) for c in columns)))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "input.csv")
            with open(path, "w") as file:
                file.write(",".join('"%s"' % str(n).replace('"', '""') for n in names) + "\n")
                for row in zip(*columns):
                    file.write(",".join(map(_number, row)) + "\n")
            return System(self.path, self._text, dict(given, input=path))

    def inverse(self, until=None, **options):
        """The motion of a system whose freedoms are all driven, and the efforts that it takes."""
        return self._simulate(lib.ct_sim_follow, _run_options(until=until, **options))

    def data(self, method=None, tolerance=None, absolute=None, step=None, backend=None,
             solver=None):
        """A state at t = 0, to be set, asked and stepped."""
        options = _run_options(method=method, tolerance=tolerance, absolute=absolute, step=step,
                               backend=backend, solver=solver)
        context = _l.Context()
        pointer = lib.ct_data_create(context.pointer, self.pointer, _byref(options))
        if not pointer:
            context.fail()
        context.warn()
        return Data(self, context, pointer)

    def sweep(self, values, until=None, tolerance=None, threads=None, take=None, **options):
        """The outputs at the end of runs with all combinations of values, {"name": array}; the last name runs fastest.
        Names are those of parameters and inputs.

        take: {"peak": "max(abs(arm.q))"}, columns of what an expression does over the run: max, min, mean, rms, final,
        time (of its first rise through zero; NaN: there is none).
        """
        names = list(values)
        if not names:
            raise ValueError("a sweep needs values of at least one parameter or input")
        axes = [np.atleast_1d(np.asarray(values[n], dtype=float)) for n in names]
        for name in names:
            if name not in self.inputs:
                self._index("parameter", name)
        table = np.array(list(product(*axes))).reshape(-1, len(names))
        taken = dict(take or {})
        columns = self.outputs + tuple(taken)
        rows, messages = np.full((len(table), len(columns)), np.nan), [None] * len(table)
        if len(table):
            with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
                file.write(",".join(names) + "\n")
                file.writelines(",".join(map(_number, row)) + "\n" for row in table)
                file.flush()
                self._study(file.name, rows, messages, until, tolerance, threads, taken, options)
        return Sweep(names, columns, table, rows, messages)

    def _study(self, members, rows, messages, until, tolerance, threads, taken, options):
        context = _l.Context()
        system, kept = _settings(**self._given)
        take = _l.strings(["%s=%s" % item for item in taken.items()])
        text = None if self._text is None else self._text.encode()
        study_options = _l.StudyOptions(
            run=_run_options(until=until, tolerance=tolerance, **options),
            members=_l.encode(members), threads=threads or 0, take=take, ntake=len(taken),
            text=text, ntext=len(text or b""))
        study_options.size = ctypes.sizeof(study_options)
        n = rows.shape[1]

        def row(_, number, varied, value, message):
            if value:
                rows[number - 1] = np.ctypeslib.as_array(value, shape=(max(n, 1),))[:n]
            else:
                messages[number - 1] = message.decode(errors="replace") if message else "failed"
            return True

        callback = _l.STUDY_ROW(row)
        results = _l.StudyResults(row=callback)
        results.size = ctypes.sizeof(results)

        def work():
            study = lib.ct_study_create(context.pointer, _l.encode(self.path), _byref(system),
                                        _byref(study_options))
            if not study:
                return False
            try:
                return lib.ct_study_run(context.pointer, study, _byref(results))
            finally:
                lib.ct_study_destroy(study)

        if not _interruptible(context, work):
            context.fail()
        del kept

    # -- analyses --

    def linearize(self, about=None, inputs=None, hold_drivers=False, **options):
        """x' = A x + B u, y = C x + D u about "initial", "equilibrium" or a time."""
        context = _l.Context()
        about = None if about is None else str(about)
        names = inputs if inputs is None or isinstance(inputs, str) else ",".join(inputs)
        o = _l.LinearizeOptions(about=_l.encode(about), inputs=_l.encode(names),
                                hold_drivers=hold_drivers, run=_run_options(**options))
        o.size = ctypes.sizeof(o)
        pointer = _interruptible(context, lambda: lib.ct_linearize(context.pointer, self.pointer,
                                                                   _byref(o)))
        if not pointer:
            context.fail()
        context.warn()
        try:
            return Linearization(pointer)
        finally:
            lib.ct_linearization_destroy(pointer)

    def modes(self, about=None, count=None, hold_drivers=False, **options):
        """Natural motions, ordered by |s|."""
        context = _l.Context()
        about = None if about is None else str(about)
        o = _l.ModesOptions(about=_l.encode(about), count=count or 0, hold_drivers=hold_drivers,
                            run=_run_options(**options))
        o.size = ctypes.sizeof(o)
        pointer = _interruptible(context, lambda: lib.ct_modes_create(
            context.pointer, self.pointer, _byref(o)))
        if not pointer:
            context.fail()
        context.warn()
        try:
            return Modes([lib.ct_modes_info(pointer, i)
                          for i in range(lib.ct_modes_count(pointer))])
        finally:
            lib.ct_modes_destroy(pointer)

    def equilibrium(self, hold_drivers=False):
        """Where the system comes to rest from its start, without inertia."""
        context = _l.Context()
        o = _l.EquilibriumOptions(hold_drivers=hold_drivers)
        o.size = ctypes.sizeof(o)
        pointer = _interruptible(context, lambda: lib.ct_equilibrium_create(
            context.pointer, self.pointer, _byref(o)))
        if not pointer:
            context.fail()
        context.warn()
        try:
            values = {n: lib.ct_equilibrium_value(pointer, n.encode()) for n in self.outputs}
            return Equilibrium(values, bool(lib.ct_equilibrium_is_stable(pointer)))
        finally:
            lib.ct_equilibrium_destroy(pointer)

    # -- texts --

    def equations(self, format="text", show=None):
        """The derivation: format "text", "latex", "html", "c" or "json"; show: stages, as in "tree,reduced", or "all"."""
        context = _l.Context()
        pointer = lib.ct_system_equations(context.pointer, self.pointer, _l.encode(show),
                                          _l.encode(format))
        text = _l.take_text(pointer)
        if text is None:
            context.fail()
        return text

    def graph(self, format="text"):
        """The linear graph and its trees: "text", "dot", "json", or "svg" where Graphviz is installed."""
        context = _l.Context()
        wanted = "dot" if format == "svg" else format
        text = _l.take_text(lib.ct_system_graph(context.pointer, self.pointer,
                                                _l.encode(wanted)))
        if text is None:
            context.fail()
        if format == "svg":
            import subprocess
            try:
                return subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True,
                                      text=True, check=True).stdout
            except FileNotFoundError:
                raise RuntimeError("graph('svg') needs the program dot of Graphviz") from None
        return text

    def _repr_latex_(self):
        import re
        text = self.equations(format="latex", show="reduced")
        found = re.findall(r"\\begin\{align\*\}.*?\\end\{align\*\}", text, re.S)
        return "$$" + "$$\n$$".join(found) + "$$" if found else None

    def _repr_html_(self):
        import html
        page = html.escape(self.equations(format="html"), quote=True)
        return '<iframe style="width:100%%;height:30em;border:0" srcdoc="%s"></iframe>' % page


class _Values:
    """Values of a kind by name, of a state."""

    def __init__(self, data, kind, is_settable):
        self._data, self._kind, self._is_settable = data, kind, is_settable

    def __getitem__(self, name):
        d = self._data
        return _value(d._pointer, _l.KINDS[self._kind], d.system._index(self._kind, name))

    def __setitem__(self, name, value):
        if not self._is_settable:
            raise TypeError("%ss cannot be set" % self._kind)
        d = self._data
        d.system._index(self._kind, name)
        if not lib.ct_data_set_one(d._context.pointer, d._pointer, _l.KINDS[self._kind],
                                   name.encode(), value):
            d._context.fail()

    def __iter__(self):
        return iter(self.keys())

    def __len__(self):
        return len(self.keys())

    def __contains__(self, name):
        return name in self.keys()

    def keys(self):
        return self._data.system._names(self._kind)

    def values(self):
        return [self[n] for n in self.keys()]

    def items(self):
        return [(n, self[n]) for n in self.keys()]

    def __repr__(self):
        return repr(dict(self.items()))


def _values(kind, is_settable=True):
    """A property of a state: values by name; a dictionary that is assigned sets those that it names."""
    def get(self):
        return _Values(self, kind, is_settable)

    def set(self, values):
        kept = get(self)
        for name, value in values.items():
            kept[name] = value
    return property(get, set)


def _quantity(number, is_matrix=False):
    def get(self):
        rows, columns = self._rows, self._columns
        p = _get(self._c, self._pointer, number, self._rows_p, self._columns_p)
        if not p:
            self._context.fail()
        n = rows.value * columns.value
        a = np.fromiter(p[:n], dtype=float, count=n)
        a.flags.writeable = False
        return a.reshape(rows.value, columns.value) if is_matrix else a
    return property(get)


class Data:
    """One state: t, q, u, states z of the model, inputs, parameters, and all that follows. One thread at a time.

    Arrays are copies that cannot be written to: set the state by d.q = ..., d.u = ..., d.z = ..., d.t = ...
    """

    __slots__ = ("system", "_context", "_pointer", "_c", "_rows", "_columns", "_rows_p",
                 "_columns_p", "_R", "_p", "_R_p", "_p_p", "__weakref__")

    def __init__(self, system, context, pointer):
        self.system, self._context, self._pointer = system, context, pointer
        self._c = context.pointer
        self._rows, self._columns = ctypes.c_size_t(), ctypes.c_size_t()
        self._rows_p, self._columns_p = _byref(self._rows), _byref(self._columns)
        self._R, self._p = np.empty((3, 3)), np.empty(3)  # of the last pose
        self._R_p, self._p_p = (a.ctypes.data_as(_double_p) for a in (self._R, self._p))

    inputs = _values("input")
    parameters = _values("parameter")
    coordinates = _values("coordinate")
    speeds = _values("speed")
    states = _values("state")
    outputs = _values("output", False)

    def __reduce__(self):
        raise TypeError("a cotree.Data cannot be pickled; send its t, q, u and z")

    def __del__(self):
        if getattr(self, "_pointer", None):
            lib.ct_data_destroy(self._pointer)
            self._pointer = None

    def _check(self, ok):
        if not ok:
            self._context.fail()

    def _set(self, kind, values):
        a = np.ascontiguousarray(values, dtype=float).ravel()
        self._check(lib.ct_data_set(self._c, self._pointer, kind, a.ctypes.data_as(_double_p),
                                    a.size))

    @property
    def t(self):
        return lib.ct_data_time(self._pointer)

    @t.setter
    def t(self, value):
        self._check(lib.ct_data_set_time(self._c, self._pointer, value))

    q = _quantity(_l.Q_COORDINATES).setter(lambda self, v: self._set(_l.COORDINATE, v))
    u = _quantity(_l.Q_SPEEDS).setter(lambda self, v: self._set(_l.SPEED, v))
    z = _quantity(_l.Q_STATES).setter(lambda self, v: self._set(_l.STATE, v))
    z_rate = _quantity(_l.Q_STATE_RATES)
    M = _quantity(_l.Q_M, True)
    Q = _quantity(_l.Q_FORCE)
    J = _quantity(_l.Q_J, True)
    gamma = _quantity(_l.Q_GAMMA)
    phi = _quantity(_l.Q_PHI)
    phi_rate = _quantity(_l.Q_PHI_RATE)
    rate = _quantity(_l.Q_RATE)
    acceleration = _quantity(_l.Q_ACCELERATION)
    multipliers = _quantity(_l.Q_MULTIPLIERS)
    y = _quantity(_l.Q_OUTPUTS)
    _energy = _quantity(_l.Q_ENERGY)

    @property
    def energy(self):
        """kinetic, potential, strain, work put in, and total."""
        return dict(zip(("kinetic", "potential", "strain", "work", "total"),
                        map(float, self._energy)))

    def step(self, dt):
        """To t + dt exactly, within the tolerance; inputs are held."""
        if not _step_function(self._c, self._pointer, dt):
            self._context.fail()

    def assemble(self):
        """The nearest coordinates and speeds that meet the constraints."""
        self._check(lib.ct_data_assemble(self._c, self._pointer))

    def reset(self):
        """The start again, with the parameters and inputs of now."""
        self._check(lib.ct_data_reset(self._c, self._pointer))

    def clone(self):
        """Another state with the same values."""
        context = _l.Context()
        pointer = lib.ct_data_clone(context.pointer, self._pointer)
        if not pointer:
            context.fail()
        context.take()
        return Data(self.system, context, pointer)

    __copy__ = clone

    def __deepcopy__(self, memo):
        return self.clone()

    def inverse(self, acceleration):
        """Efforts, one for each speed, that give these accelerations."""
        a = np.ascontiguousarray(acceleration, dtype=float).ravel()
        if a.size != len(self.system.speeds):
            raise ValueError("%d accelerations are given, and there are %d speeds"
                             % (a.size, len(self.system.speeds)))
        effort = np.zeros(a.size)
        self._check(lib.ct_data_inverse(self._c, self._pointer, a.ctypes.data_as(_double_p),
                                        effort.ctypes.data_as(_double_p)))
        self._context.warn()
        return effort

    def pose(self, frame):
        """R (3 x 3: axes of the frame -> ground) and origin p [m] of a frame, by name or number."""
        i = frame if isinstance(frame, int) else self.system._index("frame", frame)
        self._check(lib.ct_data_pose(self._c, self._pointer, i, self._R_p, self._p_p))
        return self._R.copy(), self._p.copy()

    def __repr__(self):
        return "<cotree.Data of %s at t = %g>" % (self.system.name, self.t)


class _Table:
    """Columns by name."""

    def __getitem__(self, name):
        try:
            return self._column(name)
        except (ValueError, KeyError):
            raise KeyError("there is no column %r; there are %s" % (
                name, ", ".join(self.columns))) from None

    def keys(self):
        return self.columns

    def __contains__(self, name):
        return name in self.columns

    def __len__(self):
        return len(self.values)

    def to_pandas(self):
        """A pandas DataFrame."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_pandas() needs pandas, which is not installed") from None
        return pandas.DataFrame({c: self[c] for c in self.columns})


class Result(_Table):
    """A run: t, columns by name, and `summary`, what was done."""

    def __init__(self, system, t, values, summary):
        self.name = system.name
        self.t, self.values, self.summary = t, values, summary
        self.outputs = system.outputs
        self.columns = ("t",) + system.outputs

    def _column(self, name):
        return self.t if name == "t" else self.values[:, self.outputs.index(name)]

    def __repr__(self):
        end = self.t[-1] if len(self.t) else 0
        return "<cotree.Result of %s: %d samples to t = %g, %s>" % (
            self.name, len(self.t), end, ", ".join(self.outputs))

    def _repr_svg_(self):
        return _plot(self)


class Sweep(_Table):
    """Runs with other values of parameters: columns are these, then outputs at the end; `messages` of those that failed."""

    def __init__(self, names, outputs, table, values, messages):
        self.names, self.outputs = tuple(names), tuple(outputs)
        self.columns = self.names + self.outputs
        self.table, self.values, self.messages = table, values, messages
        self.failed = sum(m is not None for m in messages)

    def _column(self, name):
        if name in self.names:
            return self.table[:, self.names.index(name)]
        return self.values[:, self.outputs.index(name)]

    def __repr__(self):
        return "<cotree.Sweep: %d members over %s, %d failed>" % (
            len(self.values), ", ".join(self.names), self.failed)


class Linearization:
    """A, B, C, D with the names of states, inputs and outputs; x, y, rate: states, outputs and rates there."""

    def __init__(self, pointer):
        rows, columns = ctypes.c_size_t(), ctypes.c_size_t()
        for name, attribute in zip("ABCDxyr", ("A", "B", "C", "D", "x", "y", "rate")):
            p = lib.ct_linearization_matrix(pointer, name.encode(), _byref(rows),
                                            _byref(columns))
            n, m = rows.value, columns.value
            a = np.array(p[:n * m] if n * m else [], dtype=float).reshape(m, n).T.copy()
            setattr(self, attribute, a if name in "ABCD" else a.ravel())
        for what, attribute in zip("xuy", ("states", "inputs", "outputs")):
            names, i = [], 0
            while True:
                text = lib.ct_linearization_name(pointer, what.encode(), i)
                if text is None:
                    break
                names.append(text.decode())
                i += 1
            setattr(self, attribute, tuple(names))

    def __repr__(self):
        return "<cotree.Linearization: states %s; inputs %s; outputs %s>" % (
            ", ".join(self.states), ", ".join(self.inputs), ", ".join(self.outputs))


class Modes:
    """Natural motions exp(s t): arrays frequency_hz, omega, damping and s, a row for each."""

    def __init__(self, info):
        self.frequency_hz = np.array([m.frequency_hz for m in info])
        self.omega = np.array([m.omega for m in info])
        self.damping = np.array([m.damping for m in info])
        self.s = np.array([complex(m.re, m.im) for m in info])

    def __len__(self):
        return len(self.s)

    def __repr__(self):
        return "<cotree.Modes: %s Hz>" % ", ".join("%.6g" % f for f in self.frequency_hz)


class Equilibrium(dict):
    """Outputs at rest by name; `is_stable`: no small motion about it grows."""

    def __init__(self, values, is_stable):
        super().__init__(values)
        self.is_stable = is_stable


def _plot(result, width=640, height=320):
    """Outputs over time as SVG, all on one axis."""
    import html
    colours = ("#4269d0", "#efb118", "#ff725c", "#6cc5b0", "#3ca951", "#ff8ab7", "#a463f2")
    shown = [(n, result[n]) for n in result.outputs[:len(colours)]]
    if not shown or len(result.t) < 2:
        return None
    left, top = 60, 10
    w, h = width - left - 150, height - top - 40
    low = min(float(np.min(v)) for _, v in shown)
    high = max(float(np.max(v)) for _, v in shown)
    high = high if high > low else low + 1
    t0, t1 = float(result.t[0]), float(result.t[-1])
    every = max(1, len(result.t) // 2000)
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" '
             'font-family="sans-serif" font-size="12">' % (width, height),
             '<rect x="%d" y="%d" width="%d" height="%d" fill="none" stroke="#888"/>'
             % (left, top, w, h)]
    for k, (name, v) in enumerate(shown):
        points = " ".join("%.1f,%.1f" % (left + w * (t - t0) / (t1 - t0),
                                         top + h * (high - x) / (high - low))
                          for t, x in zip(result.t[::every], v[::every]))
        parts.append('<polyline fill="none" stroke="%s" points="%s"/>' % (colours[k], points))
        parts.append('<text x="%d" y="%d" fill="%s">%s</text>'
                     % (left + w + 8, top + 14 + 16 * k, colours[k], html.escape(name)))
    for x, text, anchor in ((left, t0, "start"), (left + w, t1, "end")):
        parts.append('<text x="%d" y="%d" text-anchor="%s">%.4g</text>'
                     % (x, top + h + 16, anchor, text))
    parts.append('<text x="%d" y="%d" text-anchor="middle">t [s]</text>'
                 % (left + w // 2, top + h + 30))
    for y, value in ((top + 10, high), (top + h, low)):
        parts.append('<text x="%d" y="%d" text-anchor="end">%.4g</text>' % (left - 4, y, value))
    return "\n".join(parts + ["</svg>"])
