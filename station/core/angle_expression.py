"""Angles written as expressions, as in rosparam: `rad(pi/2)` and `deg(90)`.

Source: ros_comm@1.17.0 tools/rosparam/src/rosparam/__init__.py,
construct_angle_radians, construct_angle_degrees; differs: only arithmetic is
understood, in degrees too, while the original evaluates any Python.
"""

import ast
import math
import operator
from collections.abc import Callable

_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_MAX_LENGTH = 100


def parse_angle(text: str) -> float:
    """Return the angle [rad] that `rad(…)`, `deg(…)` or a bare expression says.

    Args:
        text: Numbers, `pi`, `+ - * /` and parentheses; degrees inside `deg(…)`.

    Raises:
        ValueError: The text is anything else, is longer than 100 characters, or is not
            finite.
    """
    text = text.strip()
    # Python's parser takes long for an expression of many nested parentheses.
    if len(text) > _MAX_LENGTH:
        raise ValueError(
            f"it has {len(text)} characters, and an angle may have {_MAX_LENGTH}"
        )
    degrees = text.startswith("deg(")
    if degrees or text.startswith("rad("):
        text = text[4:].removesuffix(")")
    try:
        value = _evaluate(ast.parse(text, mode="eval").body)
    except (SyntaxError, ZeroDivisionError, OverflowError) as error:
        raise ValueError(f"'{text}' is not arithmetic with numbers and pi") from error
    if not math.isfinite(value):
        raise ValueError(f"'{text}' is not finite")
    return math.radians(value) if degrees else value


def _evaluate(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id="pi"):
            return math.pi
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluate(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            return _OPERATIONS[type(op)](_evaluate(left), _evaluate(right))
    raise ValueError(f"'{ast.unparse(node)}' is neither a number nor pi")
