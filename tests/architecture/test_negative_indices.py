"""No negative index in a compiled module: the compiler reads before the memory.

Compiled, indices of lists, tuples and memory do not wrap around (`setup.py`).
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def negative_indices(source: str) -> list[int]:
    """Return the lines where something is indexed by a negative constant."""
    return [
        node.lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Subscript)
        for index in (
            node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        )
        if isinstance(index, ast.UnaryOp)
        and isinstance(index.op, ast.USub)
        and isinstance(index.operand, ast.Constant)
    ]


@pytest.mark.parametrize(
    "types", sorted(ROOT.glob("station/**/*.pxd")), ids=lambda types: types.stem
)
def test_a_compiled_module_indexes_from_the_front(types):
    assert negative_indices(types.with_suffix(".py").read_text()) == []


@pytest.mark.parametrize(
    ("line", "is_found"),
    [
        ("values[-1]", True),
        ("table[0, -1]", True),
        ("values[-1] = 0.0", True),
        ("values[len(values) - 1]", False),
        ("values[1:]", False),
        ("values[:-1]", False),
    ],
)
def test_a_negative_index_is_found(line, is_found):
    assert bool(negative_indices(line)) is is_found
