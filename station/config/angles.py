"""Angles as rosparam lets one write them: `rad(pi/2)` and `deg(90)`.

Source: ros_comm@1.17.0 tools/rosparam/src/rosparam/__init__.py,
construct_angle_radians, construct_angle_degrees; differs: arithmetic alone is
understood (the original evaluates any Python), and in degrees too.
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
_LONGEST = 100


def parse_angle(text: str) -> float:
    """Return the angle [rad] that `rad(…)`, `deg(…)` or a bare expression says.

    Args:
        text: Numbers, `pi`, `+ - * /` and parentheses; degrees inside `deg(…)`.

    Raises:
        ValueError: It is anything else, or not finite.
    """
    text = text.strip()
    degrees = text.startswith("deg(")
    if degrees or text.startswith("rad("):
        text = text[4:].removesuffix(")")
    try:
        value = _evaluate(ast.parse(text[:_LONGEST], mode="eval").body)
    except (SyntaxError, ZeroDivisionError) as error:
        raise ValueError(f"{text!r} is no angle") from error
    if not math.isfinite(value) or len(text) > _LONGEST:
        raise ValueError(f"{text!r} is no finite angle")
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
    raise ValueError(f"{ast.unparse(node)!r} is neither a number nor pi")
