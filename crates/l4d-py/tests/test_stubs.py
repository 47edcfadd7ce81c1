"""The stub says what the module has: every name, every signature, every docstring, and nothing else.

Docstrings are written once, in Rust. After a change of them `UPDATE_DOCS=1` carries them over into the stub of the source
tree; build the package again for the tests to see it.
"""

import ast
import inspect
import os
import textwrap
from pathlib import Path

import pytest

import l4d
from l4d import _native

SOURCE = (Path(l4d.__file__).parent / "_native.pyi").read_text()
STUB = ast.parse(SOURCE)
FUNCTIONS = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef)}
CLASSES = {
    node.name: node for node in STUB.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
}


def stub_members(node: ast.ClassDef) -> dict[str, ast.FunctionDef]:
    return {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}


def is_property(node: ast.FunctionDef) -> bool:
    return any(isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in node.decorator_list)


def stub_signature(node: ast.FunctionDef) -> list[tuple]:
    """(name, kind, default) of each argument but `self`."""
    arguments = node.args
    positional = [argument.arg for argument in arguments.args if argument.arg not in ("self", "cls")]
    defaults = [inspect.Parameter.empty] * (len(positional) - len(arguments.defaults))
    defaults += [ast.literal_eval(default) for default in arguments.defaults]
    signature = [
        (name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default) for name, default in zip(positional, defaults)
    ]
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        value = inspect.Parameter.empty if default is None else ast.literal_eval(default)
        signature.append((argument.arg, inspect.Parameter.KEYWORD_ONLY, value))
    return signature


def real_signature(function: object) -> list[tuple]:
    parameters = inspect.signature(function).parameters.values()
    return [(each.name, each.kind, each.default) for each in parameters if each.name != "self"]


def test_every_name_of_the_module_stands_in_the_stub_and_in_the_package() -> None:
    public = {name for name in vars(_native) if not name.startswith("_")} - {"annotations"}
    assert public == set(FUNCTIONS) | set(CLASSES)
    assert public | {"L4dError", "__version__"} == set(l4d.__all__)
    assert all(hasattr(l4d, name) for name in l4d.__all__)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_functions_take_what_the_stub_says(name: str) -> None:
    function = getattr(_native, name)
    assert real_signature(function) == stub_signature(FUNCTIONS[name])
    assert function.__doc__


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_classes_have_what_the_stub_says(name: str) -> None:
    cls, stub = getattr(_native, name), stub_members(CLASSES[name])
    assert cls.__doc__ and cls.__module__ == "l4d"
    found = {member for member in vars(cls) if not member.startswith("_")}
    found |= {"__len__"} & set(vars(cls))
    assert found == set(stub) - {"__new__"}
    if "__new__" in stub:
        assert real_signature(cls) == stub_signature(stub["__new__"])
    else:
        with pytest.raises(TypeError):
            cls()
    for member, node in stub.items():
        if member.startswith("__"):
            continue
        real = vars(cls)[member]
        assert real.__doc__, f"{name}.{member} says nothing of itself"
        assert inspect.isdatadescriptor(real) == is_property(node), member
        if not is_property(node):
            assert real_signature(real) == stub_signature(node), member


def documented() -> list[tuple[ast.AST, str]]:
    """Nodes of the stub that people look up, with what the module says of them."""
    pairs: list[tuple[ast.AST, str]] = [(node, inspect.getdoc(getattr(_native, name)) or "") for name, node in FUNCTIONS.items()]
    for name, node in CLASSES.items():
        cls = getattr(_native, name)
        pairs.append((node, inspect.getdoc(cls) or ""))
        members = stub_members(node).items()
        pairs += [(member, inspect.getdoc(vars(cls)[each]) or "") for each, member in members if not each.startswith("__")]
    return pairs


def with_docs() -> str:
    """The stub with the docstrings of the module."""
    lines = SOURCE.splitlines()
    # From the end, so that line numbers before it stay true.
    for node, text in sorted(documented(), key=lambda pair: -pair[0].lineno):
        first, indent = node.body[0], " " * (node.col_offset + 4)
        quoted = textwrap.indent(f'"""{text}"""' if "\n" not in text else f'"""{text}\n"""', indent).splitlines()
        is_literal = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
        if is_literal and first.value.value is ...:
            header = lines[first.lineno - 1][: first.col_offset].rstrip()
            lines[first.lineno - 1 : first.end_lineno] = [header, *quoted]
        elif is_literal:
            lines[first.lineno - 1 : first.end_lineno] = quoted
        else:
            start = min([first.lineno, *(each.lineno for each in getattr(first, "decorator_list", []))])
            lines[start - 1 : start - 1] = quoted
    return "\n".join(lines) + "\n"


def test_docstrings_are_those_of_the_module(root: Path) -> None:
    if os.environ.get("UPDATE_DOCS"):
        (root / "crates/l4d-py/python/l4d/_native.pyi").write_text(with_docs())
        return
    for node, text in documented():
        assert ast.get_docstring(node) == text, f"{node.name}: run the tests with UPDATE_DOCS=1"


def test_arrays_say_their_shape_and_numbers_their_unit() -> None:
    for name, node in CLASSES.items():
        for member, stub in stub_members(node).items():
            returns = ast.unparse(stub.returns) if stub.returns else ""
            kinds = ("_Floats", "_Doubles", "_Bools", "_Bytes", "_Ids")
            if any(kind in returns for kind in kinds):
                doc = vars(getattr(_native, name))[member].__doc__
                assert any(shape in doc for shape in ("(H, W", "(T, H", "(3", "(4", "(N")), f"{name}.{member}: {doc}"
            if member.endswith("_m"):
                assert "metres" in vars(getattr(_native, name))[member].__doc__, f"{name}.{member}"


def test_the_package_is_marked_as_typed() -> None:
    assert (Path(l4d.__file__).parent / "py.typed").exists()
