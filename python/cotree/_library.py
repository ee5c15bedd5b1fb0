"""The shared library as ctypes sees it: structs, signatures, and the texts and errors that it hands out.

The names are those of include/cotree/cotree.h.
"""

import ctypes
import ctypes.util
import os
import pathlib
from ctypes import POINTER, Structure, byref, c_bool, c_char_p, c_double, c_int, c_long, c_size_t
from ctypes import c_void_p

PARAMETER, INPUT, COORDINATE, SPEED, MULTIPLIER, STATE, OUTPUT, FRAME, COMPONENT = range(9)
(Q_M, Q_FORCE, Q_J, Q_GAMMA, Q_PHI, Q_ACCELERATION, Q_MULTIPLIERS, Q_OUTPUTS, Q_ENERGY,
 Q_COORDINATES, Q_SPEEDS, Q_RATE, Q_PHI_RATE, Q_STATES, Q_STATE_RATES) = range(15)
KINDS = {"output": OUTPUT, "parameter": PARAMETER, "input": INPUT, "coordinate": COORDINATE,
         "speed": SPEED, "multiplier": MULTIPLIER, "state": STATE, "frame": FRAME,
         "component": COMPONENT}


class DiagnosticStruct(Structure):
    _fields_ = [("severity", c_int), ("code", c_int), ("message", c_char_p), ("file", c_char_p),
                ("line", c_size_t), ("column", c_size_t), ("notes", c_char_p)]


class ItemStruct(Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("meaning", c_char_p),
                ("value", c_double), ("line", c_size_t), ("column", c_size_t)]


class SystemOptions(Structure):
    _fields_ = [("size", c_size_t), ("set", POINTER(c_char_p)), ("nset", c_size_t),
                ("tree", c_char_p), ("keep_all", c_bool), ("columns", c_int),
                ("for_analysis", c_bool), ("beam_elements", c_long),
                ("beam_formulation", c_char_p), ("input", c_char_p), ("hold_input", c_bool),
                ("output", POINTER(c_char_p)), ("noutput", c_size_t)]


class SimOptions(Structure):
    _fields_ = [("size", c_size_t), ("method", c_char_p), ("tolerance", c_double),
                ("absolute", c_double), ("step", c_double), ("until", c_double),
                ("samples", c_long), ("verify", c_bool), ("backend", c_char_p),
                ("solver", c_char_p)]


ROW = ctypes.CFUNCTYPE(c_bool, c_void_p, c_double, c_void_p, c_size_t)
PROGRESS = ctypes.CFUNCTYPE(c_bool, c_void_p, c_double, c_double)


class SimResults(Structure):
    _fields_ = [("size", c_size_t), ("path", c_char_p), ("bar", c_void_p),
                ("progress", PROGRESS), ("row", ROW), ("user", c_void_p)]


class ReportOptions(Structure):
    _fields_ = [("size", c_size_t), ("run", SimOptions), ("path", c_char_p), ("bar", c_void_p),
                ("command", POINTER(c_char_p)), ("ncommand", c_size_t), ("accuracy", c_void_p)]


class StudyOptions(Structure):
    _fields_ = [("size", c_size_t), ("run", SimOptions), ("vary", POINTER(c_char_p)),
                ("nvary", c_size_t), ("sample", c_long), ("seed", ctypes.c_ulonglong),
                ("threads", c_long), ("lanes", c_long), ("members", c_char_p),
                ("shard", c_long), ("shards", c_long), ("take", POINTER(c_char_p)),
                ("ntake", c_size_t), ("text", c_char_p), ("ntext", c_size_t)]


STUDY_ROW = ctypes.CFUNCTYPE(c_bool, c_void_p, c_long, POINTER(c_double), POINTER(c_double),
                             c_char_p)


class StudyResults(Structure):
    _fields_ = [("size", c_size_t), ("path", c_char_p), ("resume", c_bool), ("bar", c_void_p),
                ("progress", PROGRESS), ("row", STUDY_ROW), ("user", c_void_p)]


class EquilibriumOptions(Structure):
    _fields_ = [("size", c_size_t), ("hold_drivers", c_bool)]


class ModesOptions(Structure):
    _fields_ = [("size", c_size_t), ("about", c_char_p), ("count", c_long),
                ("hold_drivers", c_bool), ("run", SimOptions)]


class ModeInfo(Structure):
    _fields_ = [("frequency_hz", c_double), ("omega", c_double), ("damping", c_double),
                ("re", c_double), ("im", c_double)]


class LinearizeOptions(Structure):
    _fields_ = [("size", c_size_t), ("about", c_char_p), ("inputs", c_char_p),
                ("hold_drivers", c_bool), ("run", SimOptions)]


def _find():
    named = os.environ.get("COTREE_LIBRARY")
    if named:
        return named
    here = pathlib.Path(__file__).resolve().parent
    written = here / "_where.py"  # by the installation
    if written.exists():
        from . import _where
        return _where.LIBRARY
    found = ctypes.util.find_library("cotree")
    if not found:
        raise ImportError("libcotree is not found: install cotree, or let COTREE_LIBRARY name the "
                          "shared library of a build folder, as in build/libcotree.so")
    return found


def _load():
    try:
        return ctypes.CDLL(_find())
    except OSError as error:
        raise ImportError("the cotree library cannot be loaded: %s" % error) from None


lib = _load()

_P = c_void_p
_SIGNATURES = {
    "ct_ctx_create": (_P,),
    "ct_ctx_destroy": (None, _P),
    "ct_ctx_count": (c_size_t, _P),
    "ct_ctx_diagnostic": (c_bool, _P, c_size_t, POINTER(DiagnosticStruct)),
    "ct_ctx_clear": (None, _P),
    "ct_ctx_cancel": (None, _P),
    "ct_free": (None, _P),
    "ct_version": (c_char_p,),
    "ct_system_load": (_P, _P, c_char_p, POINTER(SystemOptions)),
    "ct_system_load_text": (_P, _P, c_char_p, c_size_t, c_char_p, POINTER(SystemOptions)),
    "ct_system_destroy": (None, _P),
    "ct_system_name": (c_char_p, _P),
    "ct_system_count": (c_size_t, _P, c_int),
    "ct_system_item": (c_bool, _P, c_int, c_size_t, POINTER(ItemStruct)),
    "ct_system_find": (c_long, _P, c_int, c_char_p),
    "ct_system_column_count": (c_size_t, _P),
    "ct_system_column": (c_char_p, _P, c_size_t),
    "ct_system_graph": (_P, _P, _P, c_char_p),
    "ct_system_equations": (_P, _P, _P, c_char_p, c_char_p),
    "ct_sim_create": (_P, _P, _P, POINTER(SimOptions)),
    "ct_sim_destroy": (None, _P),
    "ct_sim_run": (c_bool, _P, _P, POINTER(SimResults)),
    "ct_sim_follow": (c_bool, _P, _P, POINTER(SimResults)),
    "ct_system_report": (c_bool, _P, _P, POINTER(ReportOptions)),
    "ct_sim_summary": (_P, _P),
    "ct_sim_summary_json": (_P, _P),
    "ct_study_create": (_P, _P, c_char_p, POINTER(SystemOptions), POINTER(StudyOptions)),
    "ct_study_destroy": (None, _P),
    "ct_study_run": (c_bool, _P, _P, POINTER(StudyResults)),
    "ct_study_count": (c_long, _P),
    "ct_equilibrium_create": (_P, _P, _P, POINTER(EquilibriumOptions)),
    "ct_equilibrium_destroy": (None, _P),
    "ct_equilibrium_value": (c_double, _P, c_char_p),
    "ct_equilibrium_is_stable": (c_bool, _P),
    "ct_modes_create": (_P, _P, _P, POINTER(ModesOptions)),
    "ct_modes_destroy": (None, _P),
    "ct_modes_count": (c_size_t, _P),
    "ct_modes_info": (ModeInfo, _P, c_size_t),
    "ct_linearize": (_P, _P, _P, POINTER(LinearizeOptions)),
    "ct_linearization_destroy": (None, _P),
    "ct_linearization_matrix": (POINTER(c_double), _P, ctypes.c_char, POINTER(c_size_t),
                                POINTER(c_size_t)),
    "ct_linearization_name": (c_char_p, _P, ctypes.c_char, c_size_t),
    "ct_data_create": (_P, _P, _P, POINTER(SimOptions)),
    "ct_data_clone": (_P, _P, _P),
    "ct_data_destroy": (None, _P),
    "ct_data_reset": (c_bool, _P, _P),
    "ct_data_set": (c_bool, _P, _P, c_int, POINTER(c_double), c_size_t),
    "ct_data_set_one": (c_bool, _P, _P, c_int, c_char_p, c_double),
    "ct_data_set_time": (c_bool, _P, _P, c_double),
    "ct_data_assemble": (c_bool, _P, _P),
    "ct_data_get": (POINTER(c_double), _P, _P, c_int, POINTER(c_size_t), POINTER(c_size_t)),
    "ct_data_value": (c_double, _P, c_int, c_size_t),
    "ct_data_time": (c_double, _P),
    "ct_data_step": (c_bool, _P, _P, c_double),
    "ct_data_inverse": (c_bool, _P, _P, POINTER(c_double), POINTER(c_double)),
    "ct_data_pose": (c_bool, _P, _P, c_size_t, POINTER(c_double), POINTER(c_double)),
}
for _name, (_result, *_arguments) in _SIGNATURES.items():
    _function = getattr(lib, _name)
    _function.restype = _result
    _function.argtypes = _arguments


def encode(text):
    """Bytes of a text or a path; None stays."""
    return None if text is None else os.fsencode(text)


def strings(texts):
    """An array of C strings."""
    return (c_char_p * max(len(texts), 1))(*[encode(t) for t in texts])


def take_text(pointer):
    """The text that a function of the library has made, which is freed."""
    if not pointer:
        return None
    text = ctypes.string_at(pointer).decode()
    lib.ct_free(pointer)
    return text


class Diagnostic:
    """What the library says: severity ("error" or "warning"), code ("E111" or ""), message, file, line, column, notes."""

    def __init__(self, d):
        self.severity = ("error", "warning", "note")[d.severity]
        self.code = "E%03d" % d.code if d.code else ""
        self.message = d.message.decode(errors="replace")
        self.file = d.file.decode(errors="replace") if d.file else None
        self.line = d.line or None
        self.column = d.column or None
        self.notes = d.notes.decode(errors="replace").splitlines()

    def __str__(self):
        place = "%s:%d:%d: " % (self.file, self.line, self.column) if self.file else ""
        code = " [%s]" % self.code if self.code else ""
        notes = "".join("\n  note: " + n for n in self.notes)
        return "%s%s: %s%s%s" % (place, self.severity, self.message, code, notes)

    __repr__ = __str__


class Error(Exception):
    """A model, an option or a run has failed; `diagnostics` tells why."""

    def __init__(self, diagnostics):
        self.diagnostics = diagnostics
        errors = [d for d in diagnostics if d.severity == "error"]
        super().__init__("\n".join(str(d) for d in errors or diagnostics) or "failed")


class CotreeWarning(UserWarning):
    """A warning of the library."""


class Context:
    """Where the library puts what it has to say."""

    def __init__(self):
        self.pointer = lib.ct_ctx_create()
        if not self.pointer:
            raise MemoryError

    def __del__(self):
        if getattr(self, "pointer", None):
            lib.ct_ctx_destroy(self.pointer)
            self.pointer = None

    def take(self):
        """Diagnostics so far, which are forgotten."""
        d = DiagnosticStruct()
        found = []
        for i in range(lib.ct_ctx_count(self.pointer)):
            if lib.ct_ctx_diagnostic(self.pointer, i, byref(d)):
                found.append(Diagnostic(d))
        lib.ct_ctx_clear(self.pointer)
        return found

    def fail(self):
        raise Error(self.take())

    def warn(self, level=3):
        import warnings
        for d in self.take():
            warnings.warn(str(d), CotreeWarning, stacklevel=level)
