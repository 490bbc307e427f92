"""A parameter-varying difference equation as C99 that allocates nothing."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from typing_extensions import override

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.exports import Export
from identification.models.model import Model
from identification.models.structure import DifferenceEquation
from identification.scheduling import OneVariableBasis, ProductBasis, SchedulingVariable

EXACT = 1e-9


class CSource(Export):
    """y(t) = −Σ a_i(p(t)) y(t−i) + Σ b_i(p(t)) u(t−n_k−i) in C99; the bases as piecewise Chebyshev series.

    `lpv_coefficients` gives ζ(p), `lpv_step` one sample, `lpv_reset` rest. p outside the range is held at its end.
    """

    kind = "c"
    title = "C99 source"
    ending = "c"

    @classmethod
    @override
    def written(cls, model: Model) -> str:
        equation = model.structure.difference_equation()
        if model.effects:
            raise MisuseError("the model carries effects, which do not become C source; name its parent", "model")
        note = "/* The noise model H is left out. */\n" if model.structure.n_noise else ""
        sizes = _sizes(equation, len(model.dependence.variables))
        return "\n".join([HEAD + note + sizes, *_bases(model), _coefficients(model), _step(equation)])


HEAD = """/* A linear parameter-varying model: call lpv_reset once, then lpv_step for each sample. */
#include <stddef.h>

"""


def _sizes(equation: DifferenceEquation, variables: int) -> str:
    past = equation.n_k + equation.n_b + 1
    return (
        f"#define LPV_VARIABLES {variables}\n#define LPV_NA {equation.n_a}\n#define LPV_NB {equation.n_b + 1}\n"
        f"#define LPV_NK {equation.n_k}\n#define LPV_PAST_U {past}\n#define LPV_PAST_Y {max(equation.n_a, 1)}\n"
        f"#define LPV_SAMPLE_TIME {equation.sample_time!r}\n\n"
        "typedef struct {\n    double u[LPV_PAST_U]; /* u(t), u(t-1), ... */\n"
        "    double y[LPV_PAST_Y]; /* y(t-1), ... */\n} lpv_state;\n\n"
        f"static double lpv_limited(double p, double low, double high)\n{{\n"
        "    return p < low ? low : (p > high ? high : p);\n}\n\n"
        "static double lpv_clenshaw(const double *c, size_t n, double x)\n{\n"
        "    double next = 0.0, after = 0.0;\n    for (size_t i = n; i-- > 1;) {\n"
        "        const double here = c[i] + 2.0 * x * next - after;\n"
        "        after = next;\n        next = here;\n    }\n"
        "    return c[0] + x * next - after;\n}\n"
    )


def _plant_bases(model: Model) -> list[ProductBasis]:
    return list(model.dependence.bases[: model.structure.n_plant])


def _bases(model: Model) -> Iterator[str]:
    """A function of C for each distinct product basis: f_0(p) … at once."""
    for number, basis in enumerate(dict.fromkeys(_plant_bases(model))):
        yield _basis(number, basis, model.dependence.variables)


def _basis(number: int, basis: ProductBasis, variables: Sequence[SchedulingVariable]) -> str:
    lines = [f"static void lpv_basis_{number}(const double p[LPV_VARIABLES], double f[{basis.size}])\n{{"]
    for j in range(basis.size):
        lines.append(f"    f[{j}] = 1.0;")
    for s, (factor, variable) in enumerate(zip(basis.factors, variables, strict=True)):
        edges = _edges(factor, variable)
        series = _series(factor, variable, edges)
        pieces, size, length = series.shape
        low, high = variable.minimum, variable.maximum
        lines += [
            "    {",
            f"        static const double edges[{pieces + 1}] = {{{_numbers(edges)}}};",
            f"        static const double c[{pieces}][{size}][{length}] = {{",
            *("            {" + ", ".join(f"{{{_numbers(row)}}}" for row in piece) + "}," for piece in series),
            "        };",
            f"        const double q = lpv_limited(p[{s}], {float(low)!r}, {float(high)!r});",
            "        size_t k = 0;",
            f"        while (k + 1 < {pieces} && q >= edges[k + 1]) {{\n            ++k;\n        }}",
            "        const double x = (2.0 * q - edges[k] - edges[k + 1]) / (edges[k + 1] - edges[k]);",
        ]
        for j, label in enumerate(basis.labels):
            lines.append(f"        f[{j}] *= lpv_clenshaw(c[k][{label.split(',')[s]}], {length}, x);")
        lines.append("    }")
    return "\n".join([*lines, "}\n"])


def _edges(factor: OneVariableBasis, variable: SchedulingVariable) -> FloatArray:
    knots = [float(knot) for knot in getattr(factor, "interior_knots", ())]
    return np.array([variable.minimum, *knots, variable.maximum])


def _series(factor: OneVariableBasis, variable: SchedulingVariable, edges: FloatArray) -> FloatArray:
    """Chebyshev coefficients (pieces, functions, degree + 1), exact for piecewise polynomials; else MisuseError."""
    degree = int(getattr(factor, "degree", factor.size - 1))
    nodes = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    between = np.linspace(-0.97, 0.97, 2 * degree + 5)
    result = []
    for low, high in pairwise(edges):
        at = [low + (high - low) * (x + 1) / 2 for x in (nodes, between)]
        values, others = (factor.evaluate(p, variable.minimum, variable.maximum) for p in at)
        c = np.polynomial.chebyshev.chebfit(nodes, values, degree)
        if np.max(np.abs(np.polynomial.chebyshev.chebval(between, c).T - others)) > EXACT * max(1.0, abs(values).max()):
            raise MisuseError("a basis is no piecewise polynomial, so it does not become C source", "model")
        result.append(c.T)
    return np.array(result)


def _coefficients(model: Model) -> str:
    structure, bases = model.structure, _plant_bases(model)
    distinct = list(dict.fromkeys(bases))
    ends = np.cumsum([0, *(basis.size for basis in bases)])
    lines = [f"void lpv_coefficients(const double p[LPV_VARIABLES], double zeta[{structure.n_plant}])\n{{"]
    lines += [f"    double f_{number}[{basis.size}];" for number, basis in enumerate(distinct)]
    lines += [f"    lpv_basis_{number}(p, f_{number});" for number in range(len(distinct))]
    for i, (basis, name) in enumerate(zip(bases, structure.coefficient_names, strict=False)):
        number = distinct.index(basis)
        terms = [f"{float(t)!r} * f_{number}[{j}]" for j, t in enumerate(model.theta[ends[i] : ends[i + 1]])]
        lines.append(f"    zeta[{i}] = {' + '.join(terms)}; /* {name} */")
    return "\n".join([*lines, "}\n"])


def _step(equation: DifferenceEquation) -> str:
    return f"""void lpv_reset(lpv_state *s)
{{
    for (size_t i = 0; i < LPV_PAST_U; ++i) {{
        s->u[i] = 0.0;
    }}
    for (size_t i = 0; i < LPV_PAST_Y; ++i) {{
        s->y[i] = 0.0;
    }}
}}

double lpv_step(lpv_state *s, const double p[LPV_VARIABLES], double u)
{{
    double zeta[LPV_NA + LPV_NB], y = 0.0;
    for (size_t i = LPV_PAST_U - 1; i > 0; --i) {{
        s->u[i] = s->u[i - 1];
    }}
    s->u[0] = u;
    lpv_coefficients(p, zeta);
    {"for (size_t i = 0; i < LPV_NA; ++i) {" if equation.n_a else "/* no past output */"}
    {"    y -= zeta[i] * s->y[i];" if equation.n_a else ""}
    {"}" if equation.n_a else ""}
    for (size_t i = 0; i < LPV_NB; ++i) {{
        y += zeta[LPV_NA + i] * s->u[LPV_NK + i];
    }}
    for (size_t i = LPV_PAST_Y - 1; i > 0; --i) {{
        s->y[i] = s->y[i - 1];
    }}
    s->y[0] = y;
    return y;
}}
"""


def _numbers(values: FloatArray) -> str:
    return ", ".join(repr(float(value)) for value in values)
