"""The symmetric equation (J J^T + damping) x = b, with the Jacobian J of an arm.

Its solution gives the joint motion J^T x that moves an end effector by b with the least
effort, and the wrench x at an end effector from the joint torques tau with b = J tau.
"""

from station.memory.doubles import Doubles


class WrenchEquation:
    """The equation of one Jacobian, factorised once and solved for many b.

    J J^T = L D L^T is a matrix of 6 x 6 numbers for any number of joints; L is unit
    lower triangular, D diagonal.
    """

    def __init__(self) -> None:
        self.l10 = self.l20 = self.l21 = self.l30 = self.l31 = self.l32 = 0.0
        self.l40 = self.l41 = self.l42 = self.l43 = 0.0
        self.l50 = self.l51 = self.l52 = self.l53 = self.l54 = 0.0
        self.d0 = self.d1 = self.d2 = self.d3 = self.d4 = self.d5 = 1.0

    def factorise(self, jacobian: Doubles, damping: float) -> bool:
        """Take a Jacobian; return whether the matrix is positive definite.

        With a damping of -s^2 it is so if all singular values of J are above s.

        Args:
            jacobian: The Jacobian J of n joints, 6 n numbers, column-major.
            damping: Number to add to the diagonal.
        """
        g00, g11, g22, g33, g44, g55 = (
            damping,
            damping,
            damping,
            damping,
            damping,
            damping,
        )
        g10, g20, g21, g30, g31, g32 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        g40, g41, g42, g43, g50, g51 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        g52, g53, g54 = 0.0, 0.0, 0.0
        for k in range(0, len(jacobian), 6):
            a, b, c = jacobian[k], jacobian[k + 1], jacobian[k + 2]
            d, e, f = jacobian[k + 3], jacobian[k + 4], jacobian[k + 5]
            if not (a or b or c or d or e or f):
                continue  # a joint that is kept where it is
            # Of three numbers at most, Python makes no tuple first.
            g00, g10, g11 = g00 + a * a, g10 + b * a, g11 + b * b
            g20, g21, g22 = g20 + c * a, g21 + c * b, g22 + c * c
            g30, g31, g32 = g30 + d * a, g31 + d * b, g32 + d * c
            g33, g40, g41 = g33 + d * d, g40 + e * a, g41 + e * b
            g42, g43, g44 = g42 + e * c, g43 + e * d, g44 + e * e
            g50, g51, g52 = g50 + f * a, g51 + f * b, g52 + f * c
            g53, g54, g55 = g53 + f * d, g54 + f * e, g55 + f * f
        if not g00 > 0.0:
            return False
        l10, l20, l30, l40, l50 = g10 / g00, g20 / g00, g30 / g00, g40 / g00, g50 / g00
        d1 = g11 - l10 * g10
        if not d1 > 0.0:
            return False
        g21, g31, g41, g51 = (
            g21 - l20 * g10,
            g31 - l30 * g10,
            g41 - l40 * g10,
            g51 - l50 * g10,
        )
        l21, l31, l41, l51 = g21 / d1, g31 / d1, g41 / d1, g51 / d1
        d2 = g22 - l20 * g20 - l21 * g21
        if not d2 > 0.0:
            return False
        g32 = g32 - l30 * g20 - l31 * g21
        g42, g52 = g42 - l40 * g20 - l41 * g21, g52 - l50 * g20 - l51 * g21
        l32, l42, l52 = g32 / d2, g42 / d2, g52 / d2
        d3 = g33 - l30 * g30 - l31 * g31 - l32 * g32
        if not d3 > 0.0:
            return False
        g43 = g43 - l40 * g30 - l41 * g31 - l42 * g32
        g53 = g53 - l50 * g30 - l51 * g31 - l52 * g32
        l43, l53 = g43 / d3, g53 / d3
        d4 = g44 - l40 * g40 - l41 * g41 - l42 * g42 - l43 * g43
        if not d4 > 0.0:
            return False
        g54 = g54 - l50 * g40 - l51 * g41 - l52 * g42 - l53 * g43
        l54 = g54 / d4
        d5 = g55 - l50 * g50 - l51 * g51 - l52 * g52 - l53 * g53 - l54 * g54
        if not d5 > 0.0:
            return False
        self.l10, self.l20, self.l21, self.l30, self.l31 = l10, l20, l21, l30, l31
        self.l32, self.l40, self.l41, self.l42, self.l43 = l32, l40, l41, l42, l43
        self.l50, self.l51, self.l52, self.l53, self.l54 = l50, l51, l52, l53, l54
        self.d0, self.d1, self.d2 = g00, d1, d2
        self.d3, self.d4, self.d5 = d3, d4, d5
        return True

    def solve(self, b: Doubles, x: Doubles) -> None:
        """Solve the equation of the last Jacobian for which `factorise` was true.

        Args:
            b: The right-hand side, shape (6,).
            x: Receives the solution, shape (6,); may be `b`.
        """
        l10, l20, l30, l40 = self.l10, self.l20, self.l30, self.l40
        l50, l21, l31, l41 = self.l50, self.l21, self.l31, self.l41
        l51, l32, l42, l52 = self.l51, self.l32, self.l42, self.l52
        l43, l53, l54 = self.l43, self.l53, self.l54
        y0 = b[0]
        y1 = b[1] - l10 * y0
        y2 = b[2] - l20 * y0 - l21 * y1
        y3 = b[3] - l30 * y0 - l31 * y1 - l32 * y2
        y4 = b[4] - l40 * y0 - l41 * y1 - l42 * y2 - l43 * y3
        y5 = b[5] - l50 * y0 - l51 * y1 - l52 * y2 - l53 * y3 - l54 * y4
        y5 = y5 / self.d5
        y4 = y4 / self.d4 - l54 * y5
        y3 = y3 / self.d3 - l43 * y4 - l53 * y5
        y2 = y2 / self.d2 - l32 * y3 - l42 * y4 - l52 * y5
        y1 = y1 / self.d1 - l21 * y2 - l31 * y3 - l41 * y4 - l51 * y5
        y0 = y0 / self.d0 - l10 * y1 - l20 * y2 - l30 * y3 - l40 * y4 - l50 * y5
        x[0], x[1], x[2], x[3], x[4], x[5] = y0, y1, y2, y3, y4, y5
