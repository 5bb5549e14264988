# SPDX-License-Identifier: BSD-3-Clause
"""Compares the type stubs with the module: python3 stub_test.py, with headway on PYTHONPATH.

pybind11 states the signature of each function in the first line of its docstring. Names of parameters,
which are keyword-only, defaults, and types of parameters, results and properties must be those of the stub.
"""

import ast
import pathlib
import sys
import unittest

import headway

STUB = pathlib.Path(headway.__file__).with_name("__init__.pyi").read_text()
SAME = {"Sequence": "list", "List": "list", "Dict": "dict", "Mapping": "dict", "Tuple": "tuple"}
# Arguments that Python passes itself, whose types pybind11 does not state.
UNSTATED = {"RawlogSink.__exit__: parameter 'type'", "RawlogSink.__exit__: parameter 'value'",
            "RawlogSink.__exit__: parameter 'traceback'"}


def canonical(node):
    """A type as nested tuples: ('Optional', 'int'), ('array', 'float64')."""
    text = ast.unparse(node)
    if text == "Array":
        return ("array", "float64")
    if text in ("ArrayLike", "numpy.ndarray", "NDArray[np.void]", "NDArray[np.floating[Any]]"):
        return ("array", "any")
    if isinstance(node, ast.Subscript):
        name = ast.unparse(node.value).split(".")[-1]
        if name in ("NDArray", "ndarray"):  # numpy.float64[3, 1], np.float64
            number = node.slice.value if isinstance(node.slice, ast.Subscript) else node.slice
            return ("array", ast.unparse(number).split(".")[-1])
        if isinstance(node.slice, ast.Constant):  # float[4], a std::array's number of elements
            return name
        items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        return (SAME.get(name, name), *(canonical(item) for item in items))
    return text.split(".")[-1]


def agree(there, stub, is_parameter):
    """Whether the stub's type is the one that pybind11 states, as far as it states one."""
    if there == stub:
        return True
    if isinstance(stub, tuple) and stub[0] == "Optional":
        if isinstance(there, tuple) and there[0] == "Optional":
            return agree(there[1], stub[1], is_parameter)
        # A class that is passed as a pointer may be None.
        return is_parameter and there == stub[1] and there in headway.__all__
    if isinstance(there, tuple) and isinstance(stub, tuple) and there[0] == stub[0]:
        if there[0] == "array":
            return there[1] == "any" or (stub[1] == "any" and is_parameter)
        return len(there) == len(stub) and all(
            agree(a, b, is_parameter) for a, b in zip(there[1:], stub[1:]))
    return there in ("dict", "Iterable") and isinstance(stub, tuple) and stub[0] == there


def stated(function):
    """The signature that pybind11 states, as the definition of a function."""
    line = function.__doc__.splitlines()[0]
    name = line[: line.index("(")] or "get"
    return ast.parse(f"def {name}{line[line.index('('):]}: ...").body[0]


def defaults(arguments):
    """Default of each parameter that has one, by name."""
    positional = arguments.posonlyargs + arguments.args
    given = dict(zip([item.arg for item in positional][-len(arguments.defaults):] if
                     arguments.defaults else [], arguments.defaults))
    given.update({item.arg: value for item, value in
                  zip(arguments.kwonlyargs, arguments.kw_defaults) if value is not None})
    return {name: ast.literal_eval(value) for name, value in given.items()}


def names(arguments):
    return [[item.arg for item in group] for group in
            (arguments.posonlyargs, arguments.args, arguments.kwonlyargs)]


def differences_of_function(where, function, node):
    there = stated(function)
    if names(there.args) != names(node.args):
        return [f"{where}: parameters {names(there.args)}, in the stub {names(node.args)}"]
    found = []
    if defaults(there.args) != defaults(node.args):
        found.append(f"{where}: defaults {defaults(there.args)}, in the stub {defaults(node.args)}")
    pairs = list(zip(there.args.args + there.args.kwonlyargs, node.args.args + node.args.kwonlyargs))
    for one, other in pairs:
        if one.arg == "self":
            continue
        place = f"{where}: parameter '{one.arg}'"
        if ast.unparse(one.annotation) == "object" and place in UNSTATED:
            continue
        if not agree(canonical(one.annotation), canonical(other.annotation), True):
            found.append(f"{place}: {ast.unparse(one.annotation)}, "
                         f"in the stub {ast.unparse(other.annotation)}")
    if not agree(canonical(there.returns), canonical(node.returns), False):
        found.append(f"{where}: returns {ast.unparse(there.returns)}, "
                     f"in the stub {ast.unparse(node.returns)}")
    return found


def differences_of_class(name, node):
    found = []
    here = vars(getattr(headway, name))
    for item in node.body:
        if isinstance(item, ast.AnnAssign):
            where = f"{name}.{item.target.id}"
            there = stated(here[item.target.id].fget).returns
            if not agree(canonical(there), canonical(item.annotation), False):
                found.append(f"{where}: {ast.unparse(there)}, "
                             f"in the stub {ast.unparse(item.annotation)}")
        elif isinstance(item, ast.FunctionDef):
            found += differences_of_function(f"{name}.{item.name}",
                                             getattr(getattr(headway, name), item.name), item)
    return found


def differences(stub):
    """What a stub states otherwise than the module does."""
    found = []
    for node in ast.parse(stub).body:
        if isinstance(node, ast.FunctionDef):
            found += differences_of_function(node.name, getattr(headway, node.name), node)
        elif isinstance(node, ast.ClassDef) and node.name != "InputError":
            found += differences_of_class(node.name, node)
    return found


class Stubs(unittest.TestCase):
    def test_stubs_name_what_the_module_has(self):
        tree = ast.parse(STUB)
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        self.assertEqual(set(classes) | functions, set(headway.__all__))
        for function in functions:
            self.assertGreater(len(getattr(headway, function).__doc__.strip().splitlines()), 1, function)
        for name, node in classes.items():
            if name == "InputError":
                continue
            in_stub = {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
            in_stub |= {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            there = {item for item in vars(getattr(headway, name)) if not item.startswith("_")}
            self.assertEqual({item for item in in_stub if not item.startswith("_")}, there, name)
            self.assertTrue(getattr(headway, name).__doc__, name)
            for item in there:
                self.assertTrue(getattr(getattr(headway, name), item).__doc__, f"{name}.{item}")

    def test_signatures_and_types_are_those_of_the_module(self):
        self.assertEqual(differences(STUB), [])

    def test_a_wrong_stub_is_noticed(self):
        changes = (
            ("def load_map(path: str)", "def load_map(file: str)"),  # a name
            ("baseline_m: Optional[float]", "baseline: Optional[float]"),
            ("def load_map(path: str)", "def load_map(path: int)"),  # a parameter's type
            ("-> Map: ...", "-> Grid: ..."),  # a result's type
            ("-> list[TrackSample]: ...", "-> list[Track]: ..."),
            ("-> NDArray[np.void]: ...", "-> list[str]: ..."),
            ("now: float, *, max_age_s", "now: float, max_age_s"),  # keyword-only
            ("max_age_s: float = 0.5", "max_age_s: float = 0.6"),  # a default
            ("rawlog: Optional[str] = None", "rawlog: Optional[str]"),
            ("inliers: int", "inliers: float"),  # a property's type
            ("left: Optional[NDArray[np.uint8]]", "left: Optional[NDArray[np.float32]]"),
            ("left: Optional[NDArray[np.uint8]]", "left: NDArray[np.uint8]"),
            ("covariance: Array", "covariance: list[float]"),
            ("depth: NDArray[np.floating[Any]]", "depth: list[float]"),
        )
        for old, new in changes:
            self.assertIn(old, STUB)
            self.assertEqual(len(differences(STUB.replace(old, new, 1))), 1, new)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
